"""Free edges of shells, so that a sheet is seen from its edge as well, and where its faces look."""

import numpy as np

from crashpost.results.states import Block

# share of the area of shells that faces the eye, below which they are seen from their edges
EDGE_ON = 0.1


def borders(block: Block) -> tuple[np.ndarray, np.ndarray]:
    """Edges (e, 2) that belong to one cell alone, and the row (e,) of that cell."""
    edges_of_blocks, owners = [np.empty((0, 2), int)], [np.empty(0, int)]
    for rows, corners in block.cells:
        if corners.shape[1] not in (3, 4):
            continue
        for one, other in zip(corners.T, np.roll(corners, -1, axis=1).T, strict=True):
            edges_of_blocks.append(np.column_stack([one, other]).astype(int))
            owners.append(np.asarray(rows, int))
    edges, rows = np.concatenate(edges_of_blocks), np.concatenate(owners)
    _, first, counts = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
    )
    alone = np.sort(first[counts == 1])
    return edges[alone], rows[alone]


def are_edge_on(points: np.ndarray, corners: np.ndarray, towards: np.ndarray) -> bool:
    """Whether polygons (m, 3 or 4) hardly face an eye in a direction."""
    normals = np.cross(
        points[corners[:, 2]] - points[corners[:, 0]],
        points[corners[:, -1]] - points[corners[:, 1]],
    )
    facing = np.abs(normals @ towards).sum()
    return bool(facing < EDGE_ON * np.linalg.norm(normals, axis=1).sum())


def first_edges(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Length (m,) of the first edge of each polygon."""
    return np.linalg.norm(points[corners[:, 1]] - points[corners[:, 0]], axis=1)
