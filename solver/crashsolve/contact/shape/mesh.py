"""Mesh of triangles fixed in a body, from the card or from a file; solid on the inner side.

The corners of a triangle run counter-clockwise seen from outside. A closed mesh is solid
throughout, an open one down to `thickness` below its surface.
"""

from pathlib import Path

import numpy as np
from pydantic import model_validator

from crashsolve.contact.shape._placed import PLACED, PlacedCard, placement
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import FileName, Vec3, quantity, word
from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.mesh_files.reading import OUTLINES, MeshFileError, read_mesh_file
from crashsolve.foundation.record import Record


class Mesh(PlacedCard):
    """Mesh of triangles fixed in a body, closed, or open with a thickness."""

    vertices: tuple[Vec3, ...] | None = quantity("m", "points, shape axes", None)
    faces: tuple[tuple[int, int, int], ...] | None = word(
        "three points of each triangle, counted from 0, counter-clockwise from outside", None
    )
    file: FileName | None = word("mesh file of triangles instead, of any format meshio reads", None)
    scale: float = quantity("1", "length of the file's unit in metres", 1.0, gt=0)
    thickness: float | None = quantity(
        "m", "depth of the solid below the surface; needed when the mesh is open", None, gt=0
    )

    @model_validator(mode="after")
    def _one_source(self) -> "Mesh":
        if (self.vertices is None) != (self.faces is None):
            raise ValueError("vertices and faces belong together")
        if (self.vertices is None) == (self.file is None):
            raise ValueError("give one of: vertices and faces, file")
        return self


PARAMETERS = PLACED + Record("""
    thickness  m      depth of the solid below the surface; infinite for a closed mesh
    root       index  first box of its tree
""")


def build(card: Mesh, scene: Scene) -> list[Columns]:
    points, faces = _read(card, scene)
    edges = _check(points, faces, scene)
    is_open = bool((edges[:, 2] < 0).any())
    if is_open and card.thickness is None:
        raise scene.fail("an open mesh needs a thickness", "thickness")
    solid = {"points": points, "faces": faces, "edges": edges, "root": 0}
    thickness = np.inf if card.thickness is None else card.thickness
    return [placement(card, scene) | solid | {"thickness": thickness}]


def _read(card: Mesh, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    if card.file is None:
        assert card.vertices is not None and card.faces is not None
        return np.array(card.vertices, float), np.array(card.faces, int).reshape(-1, 3)
    try:
        mesh = read_mesh_file(Path(card.file))
    except ImportError:
        raise scene.fail(
            "reading mesh files needs meshio: pip install 'crashsolve[mesh]'", "file"
        ) from None
    except MeshFileError as error:
        raise scene.fail(f"cannot read this mesh: {error}", "file") from None
    others = sorted(set(mesh.kinds) - {"triangle", *OUTLINES})
    if others:
        message = f"holds elements of type {', '.join(others)}; this shape is made of triangles"
        raise scene.fail(message, "file")
    faces = mesh.corners[mesh.kinds == "triangle", :3]
    # formats such as STL repeat the corners of every triangle
    points, same = np.unique(mesh.points, axis=0, return_inverse=True)
    return card.scale * points, same.reshape(-1)[faces]


def _check(points: np.ndarray, faces: np.ndarray, scene: Scene) -> np.ndarray:
    """Edges (m, 3): triangle, its edge, and the triangle beyond or -1. Refuses a broken mesh."""
    if len(faces) == 0:
        raise scene.fail("has no triangles", "faces")
    if faces.min() < 0 or faces.max() >= len(points):
        raise scene.fail(
            f"a face names point {faces.min() if faces.min() < 0 else faces.max()}; "
            f"the points are 0 to {len(points) - 1}",
            "faces",
        )
    i, j, k = (points[faces[:, c]] for c in range(3))
    area = np.linalg.norm(np.cross(j - i, k - i), axis=1)
    if area.min() <= 1e-12 * float(np.ptp(points, axis=0).max()) ** 2:
        raise scene.fail(f"triangle {int(area.argmin())} has no area", "faces")
    edges = _neighbours(faces, scene)
    if (edges[:, 2] >= 0).all() and np.einsum("ij,ij->", i, np.cross(j, k)) < 0.0:
        raise scene.fail("the closed mesh is inside out: reverse the order of its faces", "faces")
    return edges


def _neighbours(faces: np.ndarray, scene: Scene) -> np.ndarray:
    """The triangle beyond each edge, which has the edge in the opposite direction."""
    ends: dict[tuple[int, int], tuple[int, int]] = {}
    for c in range(3):
        for f, (p, q) in enumerate(faces[:, (c, (c + 1) % 3)].tolist()):
            if (p, q) in ends:
                raise scene.fail(_unfit(faces, ends[p, q][0], f, (p, q)), "faces")
            ends[p, q] = f, c
    return np.array([(f, c, ends.get((q, p), (-1, 0))[0]) for (p, q), (f, c) in ends.items()])


def _unfit(faces: np.ndarray, one: int, other: int, edge: tuple[int, int]) -> str:
    """Message of two triangles that run along an edge in one direction."""
    p, q = edge
    meeting = np.flatnonzero((faces == p).any(axis=1) & (faces == q).any(axis=1))
    if len(meeting) > 2:
        names = ", ".join(map(str, meeting))
        return f"triangles {names} share the edge of points {p} and {q}, which two can"
    edge_name = f"the edge of points {p} and {q}"
    return f"triangles {one} and {other} have opposite orientations along {edge_name}"


def curvature_radius(card: Mesh) -> float | None:
    """Flat, triangle by triangle."""
    return None


def bounding(element: Columns) -> tuple[np.ndarray, float]:
    """Centre (3,) [m] in body axes and radius [m] of an enclosing sphere."""
    low, high = element["points"].min(axis=0), element["points"].max(axis=0)
    middle = 0.5 * (low + high)
    centre = element["point"] + element["axes"].reshape(3, 3) @ middle
    return centre, float(np.linalg.norm(element["points"] - middle, axis=1).max())


def half_thickness(element: Columns) -> float:
    """Half the thickness of an open mesh, half the shortest extent of a closed one [m]."""
    extent = float(np.ptp(element["points"], axis=0).min())
    return 0.5 * min(element["thickness"], extent or np.inf)


def half_width(element: Columns) -> float:
    """Half the middle one of its three extents [m]."""
    return float(0.5 * np.sort(np.ptp(element["points"], axis=0))[1])


def corners(element: Columns) -> list[Columns]:
    """The points of the mesh, as spheres of radius 0."""
    used = element["points"][distinct(element["faces"])]
    points = element["point"] + used @ element["axes"].reshape(3, 3).T
    return [{"node": element["node"], "point": point, "radius": 0.0} for point in points]
