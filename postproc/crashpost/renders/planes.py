"""Infinite planes, drawn as rectangles below the parts near them."""

from itertools import pairwise

import numpy as np

from crashpost.results.states import States

# blocks of what is fixed to the ground
FIXED = ("ground", "roads")
# a plane this near to the model, of its size, is in the picture; how far planes reach beyond it
CLOSE, PLANE_MARGIN = 0.5, 0.12


def planes(states: States) -> np.ndarray:
    """Numbers (n, 4) of the corners of rectangles of the ground that stand for infinite planes."""
    block = states.blocks.get("ground")
    if block is None or not block.cells or block.cells[0][1].shape[1] != 3:
        return np.empty((0, 4), int)
    cells = block.cells[0][1]
    uses, quads = np.bincount(cells.ravel(), minlength=len(block.points)), []
    for one, two in pairwise(cells):
        first = int(one[0])
        corners = first + np.arange(4)
        is_pair = (one == corners[:3]).all() and (two == corners[[0, 2, 3]]).all()
        if is_pair and (uses[corners] == [2, 1, 2, 1]).all():
            quads.append(corners)
    return np.array(quads, int).reshape(-1, 4)


def cut(corners: np.ndarray, near: np.ndarray) -> np.ndarray:
    """The rectangle (4, 3) in the plane of another that lies below points (n, 3), with a margin."""
    axes = np.array([corners[1] - corners[0], corners[3] - corners[0]])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    flat = (near - corners[0]) @ axes.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    # below a single point that falls a plane still reaches beyond it
    margin = PLANE_MARGIN * float(np.ptp(near, axis=0).max())
    low, high = low - margin, high + margin
    around = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    outline: np.ndarray = corners[0] + around @ axes
    return outline


def footprints(rectangles: list[np.ndarray], near: np.ndarray) -> np.ndarray:
    """Points of planes close below points (n, 3), which belong in the picture as well."""
    points = [np.empty((0, 3))]
    size = float(np.ptp(near, axis=0).max())
    for corners in rectangles:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        height = (near - corners[0]) @ normal
        if abs(height).min() < CLOSE * size:
            points.append((near - height[:, None] * normal)[[np.argmin(abs(height))]])
    return np.concatenate(points)


def by_light(
    corners: np.ndarray, selected: np.ndarray, planes: np.ndarray | None
) -> list[tuple[np.ndarray, bool]]:
    """Masks of polygons (m,), and whether they are those of infinite planes or of roads.

    `planes` are the points of these, None where polygons are those of no ground.
    """
    if planes is None:
        return [(selected, False)]
    on_plane = np.isin(corners[:, 0], planes)
    halves = [(selected & on_plane, True), (selected & ~on_plane, False)]
    return [(mask, is_plane) for mask, is_plane in halves if mask.any()]
