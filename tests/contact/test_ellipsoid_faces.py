"""Claims of ellipsoids that press on faces of shells: the nearest point, sides, what is refused."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import ArrayLike

from crashsolve.contact.cells import Near, corner_points
from crashsolve.contact.narrow import _ellipsoid_face, _face, sphere_ellipsoid
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.rows import as_rows
from crashsolve.model.build import build
from crashsolve.system.contact import ellipsoids, node_contact, normals, projection

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float) - [0.5, 0.5, 0.0]
FAR = 1e9


def rotated(rng: np.random.Generator) -> np.ndarray:
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def nearest(
    s: Sequence[float] | np.ndarray, corners: np.ndarray, far: float = FAR
) -> tuple[np.ndarray, float, np.ndarray]:
    seen = [tuple(map(float, x)) for x in corners]
    N, _, distance, m = _ellipsoid_face.nearest_to_ellipsoid(tuple(s), far, *seen)
    return np.array(N), distance, np.array(m)


def away(s: np.ndarray, x: np.ndarray) -> float:
    """Signed distance from the ellipsoid."""
    return float(sphere_ellipsoid.from_ellipsoid(tuple(s), tuple(map(float, x)))[0])


def net(corners: np.ndarray, grid: int) -> np.ndarray:
    """Places on the four triangles of a face."""
    u, v = np.meshgrid(np.linspace(0, 1, grid + 1), np.linspace(0, 1, grid + 1))
    u, v = u[u + v <= 1 + 1e-12], v[u + v <= 1 + 1e-12]
    middle = corners.mean(axis=0)
    ends = [(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    return np.concatenate(
        [np.outer(1 - u - v, middle) + np.outer(u, a) + np.outer(v, b) for a, b in ends]
    )


@pytest.mark.parametrize("seed", range(20))
def test_no_position_of_a_face_is_nearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    s = 10.0 ** rng.uniform(-1.0, 0.3, 3)
    side = 10.0 ** rng.uniform(-1.0, 1.0)
    corners = side * (SQUARE + 0.2 * rng.uniform(-1, 1, (4, 3))) @ rotated(rng)
    # any position about the ellipsoid, but not so deep that exits on several sides are as short
    corners += rng.normal(size=3)
    N, distance, m = nearest(s, corners)
    least = min(away(s, x) for x in net(corners, 10))
    if least < -0.5 * s.min():
        pytest.skip("too deep for one exit")
    assert (N >= 0.0).all() and N.sum() == pytest.approx(1.0, abs=1e-14)
    position = N @ corners
    assert away(s, position) == pytest.approx(distance, abs=1e-13 * s.max())
    assert distance <= least + 1e-12 * s.max()
    # the normal at the foot, from which the position is so far
    foot = position - distance * m
    assert np.sum((foot / s) ** 2) == pytest.approx(1.0, abs=1e-10)
    slope = foot / s**2
    np.testing.assert_allclose(m, slope / np.linalg.norm(slope), atol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_with_equal_semi_axes_it_is_the_position_nearest_to_the_centre(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = (SQUARE + 0.3 * rng.uniform(-1, 1, (4, 3))) @ rotated(rng) + rng.normal(size=3)
    N, distance, _ = nearest((0.1, 0.1, 0.1), corners)
    M, square, _ = _face.nearest_on_face(*[tuple(map(float, x)) for x in corners])
    assert distance == pytest.approx(np.sqrt(square) - 0.1, abs=1e-14)
    # the distance is of second order in the place
    np.testing.assert_allclose(N @ corners, np.array(M) @ corners, atol=1e-7)


@pytest.mark.parametrize("seed", range(10))
def test_a_far_face_is_reported_to_be_no_nearer_than_it_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    s = (0.3, 0.1, 0.2)
    corners = (SQUARE + 0.2 * rng.uniform(-1, 1, (4, 3))) @ rotated(rng)
    corners += 2.0 * corners.mean(axis=0) + rng.normal(size=3) * 2.0
    _, bound, _ = nearest(s, corners, far=0.05)
    _, distance, _ = nearest(s, corners)
    assert (bound > 0.05) == (distance > 0.05) or bound <= distance
    assert bound <= distance + 1e-13


FLOOR = {
    **{"type": "grid", "at": [-1, -0.5, 0], "along": [2, 0, 0]},
    **{"across": [0, 1, 0], "elements": [2, 1]},
}
# of quadrilaterals
DRUM = {"type": "cylinder", "radius": 1, "length": 1, "elements": [24, 1]}


def bench(
    folder: Path, semi: Sequence[float] | np.ndarray, mesh: Any = FLOOR, **words: object
) -> Any:
    """Faces of a floor and an ellipsoid, its contact moved by hand as plain Python."""
    deck = {
        "control": {"end_time": 1},
        "materials": {"m": {"type": "elastic", "young": 1e6, "poisson": 0.3, "density": 1e3}},
        "bodies": {"egg": {"mass": 1, "inertia": [1, 1, 1], "position": [0, 0, 9]}},
        "parts": {
            "floor": {
                **{"type": "shell", "thickness": 0.02, "material": "m"},
                "mesh": mesh,
            }
        },
        "surfaces": {
            "egg": {"type": "ellipsoid", "body": "egg", "semi_axes": [float(x) for x in semi]},
            "floor": {"type": "faces", "part": "floor"} | words,
        },
        "contacts": {"c": {"a": ["egg"], "b": ["floor"], "normal": {"type": "penalty"}}},
    }
    path = folder / "bench.yaml"
    path.write_text(yaml.safe_dump(deck), "utf-8")
    model, state = build(read_deck(path))
    (group,) = model.nodal_groups
    arrays = group.arrays | model.nodal_loads
    g = SimpleNamespace(**{n: as_rows(a) for n, a in arrays.items()})
    g.points, g.corners = as_rows(state.points), model.elements.corners
    g.nodes = as_rows(state.nodes)
    return g


def look(g: Any, x: ArrayLike, A: np.ndarray, is_smooth: bool = False) -> Any:
    """What the ellipsoid finds at x, a step later each time: side, depth, normal, ball's centre."""
    body, mesh = g.nodes[1], (g.points, g.corners, g.adjacent, g.around_first, g.around, g.deleted)
    body.r, body.A = x, np.ravel(A)
    g.totals[0].listed, g.due[:] = -1.0, 0.0
    lists = (g.first, g.near, g.wait, g.due)
    node_contact.clear_loads(g)
    projection.update_face_lists(
        *(0.0, g.p[0], g.totals[0], g.probes, g.nodes, g),
        Near((g.cells, g.starts, g.sorted), lists, (g.excluded_first, g.excluded)),
    )
    ellipsoids.find_nearest_faces(
        *(
            0,
            g.p[0],
            g.totals[0],
            g.ellipsoids[0],
            g.nodes,
            projection.Sides(g.probe_states, g.slot_in_use, g.hits[0]),
            mesh,
            lists,
        ),
    )
    if is_smooth:
        centre, ellipsoid_data = ellipsoids.centre_of(g.ellipsoids[0], g.nodes)
        excluded = (g.excluded_first, g.excluded)
        normals.apply_field(0, centre, ellipsoid_data, g.p[0], mesh, excluded, g.hits[0])
    hits = []
    for s in range(2):
        old, new, hit = (
            g.probe_states[g.slot_in_use[s], s],
            g.probe_states[1 - g.slot_in_use[s], s],
            g.hits[0][s],
        )
        new.depth, new.active, new.face = hit.depth, int(hit.depth > 0.0), hit.face
        new.normal = hit.normal
        if new.active or old.active:
            node_contact.mark_for_acceptance(1.0, g.slot_in_use, s)
        if new.active:
            ellipsoids.place_ball(g.balls[0], g.p[0], hit, g.nodes, g.points, g.corners)
            z = np.array(body.r) + np.reshape(body.A, (3, 3)) @ g.balls[0].at
            hits.append((s, float(hit.depth), np.array(hit.normal), z))
    return hits


@pytest.mark.parametrize("seed", range(6))
def test_on_a_flat_floor_it_is_as_deep_as_on_a_plane(seed: int, tmp_path: Path) -> None:
    semi = np.array([0.3, 0.15, 0.1])
    g, A = bench(tmp_path, semi), rotated(np.random.default_rng(seed))
    A *= np.sign(np.linalg.det(A))
    reach = np.linalg.norm(semi * A[2])
    lowest = -(A * semi**2) @ A[2] / reach
    # less than the least radius of curvature: deeper, another exit is shorter than upwards
    for drop in (0.0, 0.01, 0.03):
        x = np.array([0.1, 0.1, 0.0]) - lowest * [1.0, 1.0, 0.0] + [0.0, 0.0, reach - drop]
        ((s, depth, normal, z),) = look(g, x, A)
        assert s == 0
        # half the thickness of the floor, and what is below its mid-surface
        assert depth == pytest.approx(0.01 + drop, abs=1e-12)
        np.testing.assert_allclose(normal, [0, 0, 1], atol=1e-7)
        # a ball of the shortest semi-axis within the ellipsoid at its lowest point
        np.testing.assert_allclose(z, [0.1, 0.1, 0.1 - drop], atol=1e-7)
    assert look(g, x + [0, 0, 0.05], A) == []
    # from below it is the same the other way up
    ((s, depth, normal, _),) = look(g, [x[0], x[1], -reach + 0.01], A)
    assert s == 1 and depth == pytest.approx(0.02, abs=1e-12)
    np.testing.assert_allclose(normal, [0, 0, -1], atol=1e-7)


def test_beyond_the_border_its_side_meets_the_edge(tmp_path: Path) -> None:
    g = bench(tmp_path, (0.3, 0.15, 0.1))
    ((_, depth, normal, z),) = look(g, [1.295, 0.0, 0.0], np.eye(3))
    assert depth == pytest.approx(0.015, abs=1e-12)
    np.testing.assert_allclose(normal, [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(z, [1.095, 0, 0], atol=1e-9)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("r", [0.9, 1.08])
def test_along_a_field_it_points_to_the_axis_of_a_drum(r: float, seed: int, tmp_path: Path) -> None:
    semi, rng = np.array([0.2, 0.14, 0.1]), np.random.default_rng(seed)
    g, A, sign = bench(tmp_path, semi, DRUM, normals="continuous"), rotated(rng), np.sign(r - 1.0)
    A *= np.sign(np.linalg.det(A))
    B = A * semi**2 @ A.T
    for phi in rng.uniform(0.0, 2.0 * np.pi, 5):
        # the foot, which has the normal -m, is as far from the axis as a ball of 0.1 about r
        m = sign * np.array([np.cos(phi), np.sin(phi), 0.0])
        S = B @ m / np.sqrt(m @ B @ m)
        z = r * sign * m + [0.0, 0.0, 0.5]
        ((_, depth, normal, axis),) = look(g, z + S - 0.1 * m, A, is_smooth=True)
        np.testing.assert_allclose(normal, m, atol=1e-12)
        np.testing.assert_allclose(axis, z, atol=1e-12)
        half = np.pi / 24
        chord = np.cos(half) / np.cos(phi % (2.0 * half) - half)
        assert depth == pytest.approx(0.11 - abs(r - chord), abs=1e-12)
        g.probe_states.active = 0


@pytest.mark.parametrize("seed", range(4))
def test_the_way_to_the_centre_changes_by_its_derivative(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    g = bench(tmp_path, (0.3, 0.15, 0.1))
    g.nodes[1].A = np.ravel(rotated(rng))
    _, ellipsoid_data = ellipsoids.centre_of(g.ellipsoids[0], g.nodes)
    n, d, step = rng.normal(size=3), rng.normal(size=3), 1e-5
    ends = [
        np.array(ellipsoids.centre_from_ball(ellipsoid_data, tuple(n + k * step * d)))
        for k in (1, -1)
    ]
    derivative = ellipsoids.change_of_centre(ellipsoid_data, tuple(n), tuple(d))
    # central differences: round-off 1e-11, third order 1e-10
    np.testing.assert_allclose(derivative, (ends[0] - ends[1]) / (2.0 * step), atol=1e-8)


def test_the_corners_of_a_face_are_where_the_shell_is(tmp_path: Path) -> None:
    g = bench(tmp_path, (0.3, 0.2, 0.1))
    at = corner_points(g.p[0], 0, g.corners)
    seen = ellipsoids.local_corners(g.ellipsoids[0], g.nodes[1], g.p[0], 0, (g.points, g.corners))
    np.testing.assert_allclose(np.array(seen) + g.nodes[1].r, np.array(g.points.r)[list(at)])
