"""Meshes: the chapter's triangle test corrected, nearest triangle, signs, thickness, reading."""

from pathlib import Path

import numpy as np
import pytest
from touching import Contact

from crashsolve.contact.narrow import _tree, sphere_mesh
from crashsolve.contact.shape import mesh as shape
from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.rows import as_rows

CUBE = 0.5 * np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
CUBE_FACES = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4]]
CUBE_FACES += [[2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
FIXED = "bodies:\n  a: {mass: 1, inertia: [1, 1, 1]}\n"
HEAD = f"title: mesh\ncontrol: {{end_time: 1}}\n{FIXED}"


class Probe:
    """A mesh alone, asked by points in its own axes; kernels as plain Python."""

    def __init__(self, points: np.ndarray, faces: np.ndarray) -> None:
        edges = shape._check(points, faces, None)
        element = {"points": points, "faces": faces, "edges": edges}
        tree, triangles = _tree.data(None, [element])
        self.tree, self.triangles = as_rows(tree), as_rows(triangles)

    def nearest(self, y: np.ndarray) -> tuple[np.ndarray, int]:
        kernel = sphere_mesh.nearest
        foot, _, at = kernel(self.tree, self.triangles, 0, tuple(map(float, y)))
        return np.array(foot), at


def test_the_edge_products_are_those_of_the_corrected_equation() -> None:
    i, j, third, k = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.2, 0.2, -0.01)
    products = sphere_mesh.edge_products(i, j, third, k, (0.0, 0.0, 1.0))
    np.testing.assert_allclose(products, (0.2, 0.6, 0.2), rtol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_the_nearest_point_is_that_of_a_search_over_all_triangles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, faces = ball(2, rng)
    probe = Probe(points, faces)
    for y in rng.uniform(-1.5, 1.5, (40, 3)):
        foot, _ = probe.nearest(y)
        assert np.linalg.norm(y - foot) == pytest.approx(distance(points[faces], y), abs=1e-14)


def ball(level: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A closed bumpy surface: a cube refined and blown up."""
    points, faces = CUBE.copy(), np.array(CUBE_FACES)
    for _ in range(level):
        middle: dict[tuple[int, int], int] = {}
        finer = []
        grown = list(points)
        for face in faces:
            half = []
            for p, q in zip(face, np.roll(face, -1), strict=True):
                key = (min(p, q), max(p, q))
                if key not in middle:
                    middle[key] = len(grown)
                    grown.append(0.5 * (points[p] + points[q]))
                half.append(middle[key])
            a, b, c = half
            finer += [[face[0], a, c], [face[1], b, a], [face[2], c, b], [a, b, c]]
        points, faces = np.array(grown), np.array(finer)
    points /= np.linalg.norm(points, axis=1)[:, None]
    return points * rng.uniform(0.8, 1.2, (len(points), 1)), faces


def distance(corners: np.ndarray, y: np.ndarray) -> float:
    """Distance of y from the nearest of the triangles (n, 3, 3)."""
    a, b, c = (corners[:, k] for k in range(3))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1)[:, None]
    height = np.einsum("ij,ij->i", y - a, n)
    foot = y - height[:, None] * n
    ends = ((a, b), (b, c), (c, a))
    inside = [np.einsum("ij,ij->i", np.cross(q - p, foot - p), n) >= 0.0 for p, q in ends]
    flat = np.where(np.all(inside, axis=0), np.abs(height), np.inf)
    along = [np.clip(_dots(y - p, q - p) / _dots(q - p, q - p), 0, 1) for p, q in ends]
    edge = [
        np.linalg.norm(y - p - s[:, None] * (q - p), axis=1)
        for s, (p, q) in zip(along, ends, strict=True)
    ]
    return float(min(flat.min(), *(e.min() for e in edge)))


def _dots(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.asarray((x * y).sum(axis=1))


@pytest.mark.parametrize("seed", range(5))
def test_the_sign_is_that_of_the_solid_angle(tmp_path: Path, seed: int) -> None:
    """A point is inside where the surface is seen under 4 pi (Van Oosterom and Strackee 1983)."""
    rng = np.random.default_rng(seed)
    points, faces = ball(1, rng)
    contact = sheet(tmp_path, points, faces.tolist())
    for y in rng.uniform(-1.2, 1.2, (40, 3)):
        depth, n, _ = depth_at(contact, y)
        a, b, c = (points[faces[:, k]] - y for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        below = la * lb * lc + _dots(a, b) * lc + _dots(b, c) * la + _dots(c, a) * lb
        rotations = np.arctan2(_dots(a, np.cross(b, c)), below).sum() / (2 * np.pi)
        assert (depth > 0.0) == (rotations > 0.5)
        assert abs(depth) == pytest.approx(distance(points[faces], y), abs=1e-13)
        # along the normal the depth falls one for one
        assert depth_at(contact, y + 1e-7 * n)[0] == pytest.approx(depth - 1e-7, abs=1e-13)


def sheet(folder: Path, points: np.ndarray, faces: list[list[int]], extra: str = "") -> Contact:
    """A point of body a over a mesh fixed in the ground."""
    surfaces = (
        "surfaces:\n  point: {type: point_set, body: a, points: [[0, 0, 0]]}\n"
        f"  mesh: {{type: mesh, vertices: {points.tolist()}, faces: {faces}{extra}}}\n"
    )
    return Contact(folder, surfaces=surfaces, sides="a: [point], b: [mesh]", bodies=HEAD)


def depth_at(contact: Contact, y: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    contact.bench.move(1, r=y)
    return contact.deepest()


def test_an_edge_shared_by_two_triangles_is_met_once(tmp_path: Path) -> None:
    contact = sheet(tmp_path, CUBE, CUBE_FACES)
    assert len(contact.gaps()) == 1
    # over the diagonal of the top face, and along it to both sides
    for side in (-1e-9, 0.0, 1e-9):
        depth, n, _ = depth_at(contact, np.array([0.2 + side, -0.2, 0.49]))
        assert depth == pytest.approx(0.01, abs=1e-14)
        np.testing.assert_allclose(n, [0, 0, 1], atol=1e-12)


def test_edges_and_corners_are_round_outside(tmp_path: Path) -> None:
    contact = sheet(tmp_path, CUBE, CUBE_FACES)
    for y, away in (((0.8, 0.1, 0.9), (0.3, 0, 0.4)), ((0.6, 0.7, 0.7), (0.1, 0.2, 0.2))):
        depth, n, _ = depth_at(contact, np.array(y))
        length = np.linalg.norm(away)
        assert depth == pytest.approx(-length, abs=1e-14)
        np.testing.assert_allclose(n, np.array(away) / length, atol=1e-13)


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
HALVES = [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(
    "y, depth",
    [
        ((0.4, 0.3, 0.2), -0.2),  # above
        ((0.4, 0.3, -0.05), 0.05),  # in the solid
        ((0.4, 0.3, -0.3), -0.2),  # behind it
        ((1.3, 0.5, -0.4), -0.5),  # below and beside: an open edge has no inside
        ((1.3, 0.5, 0.4), -0.5),
    ],
)
def test_an_open_mesh_is_solid_down_to_its_thickness(
    tmp_path: Path, y: tuple[float, ...], depth: float
) -> None:
    contact = sheet(tmp_path, SQUARE, HALVES, ", thickness: 0.1")
    assert depth_at(contact, np.array(y))[0] == pytest.approx(depth, abs=1e-14)


WRONG = {
    "thickness: an open mesh needs a thickness": (SQUARE, HALVES, ""),
    "faces: triangle 1 has no area": (SQUARE, [[0, 1, 2], [0, 3, 0]], ""),
    "faces: a face names point 4; the points are 0 to 3": (SQUARE, [[0, 1, 4]], ""),
    "faces: triangles 0 and 1 have opposite orientations along the edge of points 0 and 1": (
        SQUARE,
        [[0, 1, 2], [0, 1, 3]],
        "",
    ),
    "faces: triangles 0, 1, 2 share the edge of points 0 and 1, which two can": (
        np.vstack([SQUARE, [0, 0, 1]]),
        [[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        "",
    ),
    "faces: the closed mesh is inside out: reverse the order of its faces": (
        CUBE,
        [face[::-1] for face in CUBE_FACES],
        "",
    ),
    "faces: has no triangles": (SQUARE, [], ""),
    "give one of: vertices and faces, file": (SQUARE, HALVES, ", file: bench.yaml"),
    "file: cannot read this mesh": (None, None, "file: bench.yaml"),
}


@pytest.mark.parametrize("message", WRONG)
def test_a_broken_mesh_is_refused(tmp_path: Path, message: str) -> None:
    points, faces, extra = WRONG[message]
    with pytest.raises(DeckErrors) as refused:
        if points is None:
            surfaces = f"surfaces:\n  m: {{type: mesh, {extra}}}\n"
            Contact(tmp_path, surfaces=surfaces, sides="a: [m], b: [m]", bodies=HEAD)
        else:
            sheet(tmp_path, points, faces, extra)
    assert f"surface '{'m' if points is None else 'mesh'}': {message}" in str(refused.value)
    assert str(refused.value).count("error:") == 1


@pytest.mark.parametrize("format", ("stl", "obj", "vtu"))
def test_a_mesh_may_come_from_a_file(tmp_path: Path, format: str) -> None:
    meshio = pytest.importorskip("meshio")
    millimetres = 1000.0 * CUBE
    cells = [("triangle", np.array(CUBE_FACES))]
    meshio.write(tmp_path / f"cube.{format}", meshio.Mesh(millimetres, cells))
    surfaces = (
        "surfaces:\n  point: {type: point_set, body: a, points: [[0, 0, 0]]}\n"
        f"  cube: {{type: mesh, file: cube.{format}, scale: 1e-3}}\n"
    )
    contact = Contact(tmp_path, surfaces=surfaces, sides="a: [point], b: [cube]", bodies=HEAD)
    # STL keeps single precision
    assert depth_at(contact, np.array([0.1, 0.2, 0.45]))[0] == pytest.approx(0.05, abs=1e-7)
    assert depth_at(contact, np.array([0.0, 0.0, 0.8]))[0] == pytest.approx(-0.3, abs=1e-7)
