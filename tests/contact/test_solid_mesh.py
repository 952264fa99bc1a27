"""Boxes and cylinders on meshes: planes in any triangulation, ridges, corners, exits of edges."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from bench import exponential
from scipy.spatial import Delaunay
from test_mesh import HEAD
from touching import Contact

from crashsolve.contact.narrow import _ridges
from crashsolve.contact.shape import mesh as shape
from crashsolve.foundation.errors import DeckErrors

BOX, CYLINDER = "type: box, size: [0.4, 0.3, 0.2]", "type: cylinder, radius: 0.1, length: 0.4"
SHAPES = {"box": BOX, "cylinder": CYLINDER}
ROOF = "vertices: [[-2, -1, -1], [2, -1, -1], [2, 0, 0], [-2, 0, 0], [2, 1, -1], [-2, 1, -1]]"
ROOF += ", faces: [[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]], thickness: 0.2"
VALLEY = ROOF.replace(", -1]", ", 1]")


def over(folder: Path, body: str, mesh: str) -> Contact:
    """A shape of body a over a mesh fixed in the ground, or over the plane z = 0."""
    mesh = f"type: mesh, {mesh}" if mesh else "type: plane"
    surfaces = f"surfaces:\n  one: {{{body}, body: a}}\n  mesh: {{{mesh}}}\n"
    return Contact(folder, surfaces=surfaces, sides="a: [one], b: [mesh]", bodies=HEAD)


def flat(seed: int) -> str:
    """A square of 4 m, cut into triangles at random points."""
    rng = np.random.default_rng(seed)
    square = [[-2, -2], [2, -2], [2, 2], [-2, 2]]
    points = np.vstack([square, rng.uniform(-1.9, 1.9, (12 * seed, 2))])
    faces = Delaunay(points).simplices
    points = np.column_stack([points, np.zeros(len(points))]).tolist()
    return f"vertices: {points}, faces: {faces.tolist()}, thickness: 0.5"


@pytest.mark.parametrize("word", SHAPES)
@pytest.mark.parametrize("seed", range(3))
def test_a_flat_mesh_is_a_plane_however_it_is_cut(tmp_path: Path, word: str, seed: int) -> None:
    plane = over(tmp_path, SHAPES[word], "")
    mesh = over(tmp_path, SHAPES[word], flat(seed))
    rng = np.random.default_rng(seed)
    lying = [exponential(x) for x in ([0, 0, 0], [0.5 * np.pi, 0, 0], [0, 1e-5, 0])]
    for q in [*lying, *(exponential(rng.uniform(-1.5, 1.5, 3)) for _ in range(5))]:
        for contact in (plane, mesh):
            contact.bench.move(1, r=[0.1, -0.2, 0.09], q=q)
        expected, gaps = plane.gaps(), mesh.gaps()
        *positions, edges = gaps
        for (d, n, x), (depth, n_mesh, x_mesh) in zip(expected, positions, strict=True):
            # the mesh is solid down to 0.5 m; round-off of a metre
            assert depth == pytest.approx(d, abs=1e-14)
            np.testing.assert_allclose(n_mesh, n, atol=1e-14)
            np.testing.assert_allclose(x_mesh, x, atol=1e-14)
        assert max(d for d, _, _ in expected) > 0.0
        # its border is the only edge
        assert edges[0] < -1.0


@pytest.mark.parametrize("is_round", [0, 1])
@pytest.mark.parametrize("seed", range(20))
def test_an_edge_leaves_by_the_shortest_exit(is_round: int, seed: int) -> None:
    """Of all directions n: h_a(n) + h_s(n) - |m . n|, by brute force."""
    rng = np.random.default_rng(seed)
    half = np.array([0.2, 0.2, 0.3]) if is_round else np.array([0.2, 0.15, 0.3])
    a = SimpleNamespace(half=half, is_round=is_round)
    m, g = rng.uniform(-0.25, 0.25, 3), rng.normal(size=3) * rng.uniform(0.05, 0.6)
    shortest, n, t = _ridges.exit_of(a, tuple(map(float, m)), tuple(map(float, g)))
    u, width, least = rng.normal(size=(20000, 3)), 0.03, np.inf
    while width > 1e-8:
        u /= np.linalg.norm(u, axis=1)[:, None]
        before = least
        least, best = overlap(half, is_round, m, g, u)
        width *= 0.6 if least == before else 1.0
        u = np.vstack([best, best + width * rng.normal(size=(200, 3))])
    # no direction has a shorter exit, and this one is that long
    assert shortest <= least + 1e-12
    assert overlap(half, is_round, m, g, np.array([n]))[0] == pytest.approx(shortest, abs=1e-12)
    if shortest > 0.0:
        # the point on the edge is within the body
        x = np.abs(m + t * g)
        within = np.hypot(x[0], x[1]) <= 0.2 + 1e-12 if is_round else (x <= half + 1e-12).all()
        assert within and x[2] <= 0.3 + 1e-12


def overlap(
    half: np.ndarray, is_round: int, m: np.ndarray, g: np.ndarray, u: np.ndarray
) -> tuple[float, np.ndarray]:
    """Least overlap along directions u (k, 3), and the direction."""
    if is_round:
        reach = half[0] * np.hypot(u[:, 0], u[:, 1]) + half[2] * np.abs(u[:, 2])
    else:
        reach = np.abs(u) @ half
    value = reach + np.abs(u @ g) - np.abs(u @ m)
    return float(value.min()), u[value.argmin()]


@pytest.mark.parametrize("word", SHAPES)
def test_a_ridge_is_met_where_no_corner_is_over_the_mesh(tmp_path: Path, word: str) -> None:
    contact = over(tmp_path, SHAPES[word], ROOF)
    # a cylinder across the ridge, a box flat upon it
    q = exponential([0.5 * np.pi, 0, 0]) if word == "cylinder" else exponential([0, 0, 0.3])
    contact.bench.move(1, r=[0.3, 0.02, 0.1 - 0.003], q=q)
    *positions, (depth, n, x) = contact.gaps()
    assert depth == pytest.approx(0.003, abs=1e-14)
    np.testing.assert_allclose(n, [0, 0, 1], atol=1e-14)
    np.testing.assert_allclose(x[1:], [0, 0], atol=1e-14)
    # no position of the body is within the roof
    assert max(d for d, _, _ in positions) < 0.0


def test_a_valley_has_no_edges(tmp_path: Path) -> None:
    contact = over(tmp_path, BOX, VALLEY)
    contact.bench.move(1, r=[0.0, 0.0, 0.3])
    # but for the border, more than half a metre away
    assert contact.gaps()[-1][0] < -0.5


def test_edges_in_line_are_one_and_flat_ones_none() -> None:
    points = np.array([[x, y, -abs(y)] for x in (0, 1, 2, 3) for y in (-1, 0, 1)], float)
    faces = []
    for i in range(3):
        for j in range(2):
            p = 3 * i + j
            faces += [[p, p + 3, p + 4], [p, p + 4, p + 1]]
    edges = shape._check(points, np.array(faces), None)
    ends = _ridges._ridges({"points": points, "faces": np.array(faces), "edges": edges})
    assert {tuple(sorted(map(tuple, e.tolist()))) for e in ends} == {
        ((0, 0, 0), (3, 0, 0)),
        ((0, -1, -1), (3, -1, -1)),
        ((0, 1, -1), (3, 1, -1)),
        ((0, -1, -1), (0, 0, 0)),
        ((0, 0, 0), (0, 1, -1)),
        ((3, -1, -1), (3, 0, 0)),
        ((3, 0, 0), (3, 1, -1)),
    }


def test_two_meshes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DeckErrors, match="no contact between a mesh"):
        over(tmp_path, f"type: mesh, {ROOF}", VALLEY)
