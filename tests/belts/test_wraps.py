"""Belts over bodies: geodesics, silhouettes, friction over the angle wrapped, energy."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from bench import Bench, Law, assert_balanced, refusal
from numpy.typing import ArrayLike
from quick import first_quick
from scipy.optimize import minimize

from crashsolve.belts._ellipsoid import over_ellipsoid
from crashsolve.belts._route import FITTINGS, SURFACES, surface_row
from crashsolve.belts._wrap import over_cylinder, over_sphere

BODIES = """
title: belt over a body
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [0.1, -0.6, 0.05]}
  b:
    mass: 3
    inertia: [0.7, 0.5, 0.9]
    position: [-0.06, 0, 0]
    rotation: {axis: [1, 2, 3], angle: 0.4}
surfaces:
  ball: {type: sphere, body: b, radius: 0.2}
  egg: {type: ellipsoid, body: b, at: [0.01, 0, 0.02], semi_axes: [0.2, 0.15, 0.25]}
  roll: {type: cylinder, body: b, axis: [0, 0, 1], radius: 0.2, length: 2}
  box: {type: box, body: b, size: [1, 1, 1]}
"""
SEMI = (0.15, 0.2, 0.1)
# a belt that was not on its ellipsoid before
NEW = (0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)


def belt(
    folder: Path, surface: str, mu: float, slack: float = -0.05, at: Sequence[float] = (0, 0.6, 0)
) -> Law:
    text = (
        f"belts:\n  s:\n    webbing: {{stiffness: 1e5}}\n    slack: {slack}\n    route:\n"
        f"      - {{anchor: {{at: {list(at)}}}}}\n"
        f"      - {{wrap: {{surface: {surface}, friction_coefficient: {mu}}}}}\n"
        "      - {anchor: {body: a}}\n"
    )
    return Bench(folder, text, BODIES).law("belts", "s")


def length_over(arc: SimpleNamespace, A: ArrayLike, B: ArrayLike) -> float:
    straight = np.linalg.norm(np.subtract(arc.first, A)) + np.linalg.norm(np.subtract(B, arc.last))
    return float(straight + arc.length)


def ends(seed: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two points on about opposite sides."""
    rng = np.random.default_rng(seed)
    u = rng.normal(size=3)
    u /= np.linalg.norm(u)
    v = -u + 0.4 * rng.normal(size=3)
    return tuple(0.5 * u), tuple(0.4 * v / np.linalg.norm(v))


@pytest.mark.parametrize("seed", range(6))
def test_an_ellipsoid_of_equal_axes_is_a_sphere(seed: int) -> None:
    A, B = ends(seed)
    sphere, same = over_sphere(0.2, A, B), over_ellipsoid((0.2, 0.2, 0.2), A, B, NEW)
    assert sphere.touches == same.touches == 1
    # some 30 steps of fourth order over at most half a turn
    assert length_over(same, A, B) == pytest.approx(length_over(sphere, A, B), rel=1e-8)
    np.testing.assert_allclose(same.first, sphere.first, atol=1e-6)
    np.testing.assert_allclose(same.last, sphere.last, atol=1e-6)
    assert same.bend == pytest.approx(sphere.bend, rel=1e-7)


@pytest.mark.parametrize("seed", [1, 2])
def test_the_geodesic_is_the_shortest_line_around_an_ellipsoid(seed: int) -> None:
    A, B = ends(seed)
    arc = over_ellipsoid(SEMI, A, B, NEW)
    assert arc.touches == 1
    length = length_over(arc, A, B)
    # 200 chords of an arc of one to two radii are short of it by (2/200)^2 / 24
    assert _shortest(np.array(A), np.array(B), np.array(SEMI)) == pytest.approx(length, rel=1e-5)


def _shortest(
    A: np.ndarray, B: np.ndarray, semi: np.ndarray, approximate_length: int = 200
) -> float:
    """Shortest line of chords over an ellipsoid that passes through it nowhere."""
    a, b, x = A / semi, B / semi, np.linspace(-1.0, 1.0, approximate_length)
    e = a / np.linalg.norm(a)
    f = b - e * (e @ b)
    f /= np.linalg.norm(f)
    n, between = np.cross(e, f), np.arctan2(b @ f, b @ e)

    def length(c: np.ndarray) -> float:
        angle = c[0] + 0.5 * (c[1] - c[0]) * (x + 1.0)
        side = np.polynomial.legendre.legval(x, c[2:])
        y = np.cos(side)[:, None] * (np.cos(angle)[:, None] * e + np.sin(angle)[:, None] * f)
        y += np.sin(side)[:, None] * n
        hidden = max(0.0, 1.0 - y[0] @ a) + max(0.0, 1.0 - y[-1] @ b)
        line = np.vstack([A, y * semi, B])
        return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() + 10.0 * hidden)

    start = [np.arccos(1 / np.linalg.norm(a)), between - np.arccos(1 / np.linalg.norm(b)), *5 * [0]]
    options = {"xatol": 1e-9, "fatol": 1e-12, "maxfev": 8000, "adaptive": True}
    return float(minimize(length, start, method="Nelder-Mead", options=options).fun)


def test_a_helix_is_a_straight_line_on_the_cylinder_unrolled() -> None:
    A, B, R = (0.5, 0.0, -0.2), (-0.5, 0.1, 0.4), 0.2
    arc = over_cylinder(R, A, B, 1.0, 0.0)
    a, b = np.hypot(*A[:2]), np.hypot(*B[:2])
    turned = np.arctan2(B[1], B[0]) - np.arccos(R / a) - np.arccos(R / b)
    plane = np.sqrt(a * a - R * R) + np.sqrt(b * b - R * R) + R * turned
    assert length_over(arc, A, B) == pytest.approx(np.hypot(plane, B[2] - A[2]), rel=1e-12)
    # the tangents meet the points: leaving direction is that of the straight line
    leaves = np.subtract(B, arc.last) / np.linalg.norm(np.subtract(B, arc.last))
    assert leaves[2] == pytest.approx((B[2] - A[2]) / np.hypot(plane, B[2] - A[2]), rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    "surface", ["ball", *(pytest.param(s, marks=pytest.mark.long) for s in ("egg", "roll"))]
)
def test_length_and_force_are_continuous_across_the_silhouette(
    tmp_path: Path, surface: str
) -> None:
    law = belt(tmp_path, surface, 0.3)
    rows, touched = [], []
    # from well on the body to well off it, a tenth of a millimetre a step
    x = np.linspace(0.1, 0.6, 5001)
    for far in x:
        law.bench.move(1, r=[far, -0.6, 0.05])
        law.bench.move(2, r=[0.02, 0.0, 0.0])
        law.force(1e-3)
        law.accept()
        rows.append([law.out.length[:2].sum(), *law.out.force[:2]])
        touched.append(law.new.touches[0])
    assert touched[0] == 1 and touched[-1] == 0
    lengths, forces = np.array(rows)[:, 0], np.array(rows)[:, 1:]
    # a step is at most as much belt
    assert np.abs(np.diff(lengths)).max() <= 1.01e-4
    # and at most k over the shorter segment of force
    assert np.abs(np.diff(forces, axis=0)).max() <= 1e5 / 0.4 * 1e-4
    off = np.array(touched) == 0
    np.testing.assert_allclose(forces[off][:, 0], forces[off][:, 1], rtol=1e-9, atol=1e-7)
    straight = np.hypot(np.hypot(x, 1.2), 0.05)
    np.testing.assert_allclose(lengths[off], straight[off], rtol=1e-12)


@pytest.mark.parametrize("surface", ["ball", "egg", "roll"])
def test_friction_is_that_of_the_angle_wrapped(tmp_path: Path, surface: str) -> None:
    mu = 0.25
    law = belt(tmp_path, surface, mu)
    for _ in range(50):
        law.bench.move(1, r=law.bench.nodes[1].r + np.array([0.0, -0.002, 0.0]))
        law.force(1e-3)
        law.accept()
    beta = float(law.out.angle[1])
    assert beta > 0.25
    assert law.out.force[1] / law.out.force[0] == pytest.approx(np.exp(mu * beta), rel=1e-8)


@pytest.mark.parametrize("surface", first_quick(["ball", "egg", "roll"]))
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_energy_closes_as_bodies_turn_under_the_belt(
    tmp_path: Path, surface: str, mu: float
) -> None:
    errors = []
    for steps in (50, 200):
        law = belt(tmp_path, surface, mu, slack=-0.2)
        law.force(0.0)
        first, work, lost = float(law.out.stored), 0.0, 0.0
        h = 1.0 / steps
        law.bench.move(1, v=[0.05, -0.1, 0.1], w=[0, 0, 0])
        law.bench.move(2, v=[0.05, 0.02, -0.03], w=[0.1, -0.1, 0.3])
        before = law.power_on_bodies()
        for _ in range(steps):
            law.bench.drift(h)
            law.force(h)
            now = law.power_on_bodies()
            work += 0.5 * h * (before + now)
            lost += float(law.out.loss)
            before = now
            law.accept()
        assert law.new.touches[0] == 1
        # round-off of sums of some 1e3 J
        assert lost >= -1e-9
        errors.append(abs(work + lost + float(law.out.stored) - first))
    # second order, down to what the shots on an ellipsoid are known to
    assert errors[1] <= max(0.1 * errors[0], 1e-4)
    assert errors[1] <= 2e-2


@pytest.mark.parametrize("surface", ["ball", "egg", "roll"])
def test_action_equals_reaction_over_a_body(tmp_path: Path, surface: str) -> None:
    law = belt(tmp_path, surface, 0.3)
    law.force(1e-3)
    nodes = law.bench.nodes
    assert_balanced(nodes) if surface != "ball" else None
    np.testing.assert_allclose(nodes.force.sum(axis=0), 0.0, atol=1e-9)


def test_a_route_that_begins_within_the_body_is_refused(tmp_path: Path) -> None:
    text = (
        "belts:\n  s:\n    webbing: {stiffness: 1e5}\n    route:\n"
        "      - {anchor: {at: AT}}\n      - {wrap: {surface: SURFACE}}\n"
        "      - {anchor: {body: a}}\n"
    )
    said = refusal(tmp_path, BODIES + text.replace("AT", "[0, 0, 0.1]").replace("SURFACE", "egg"))
    assert "contains the fitting" in said and "deck.yaml:" in said
    # a straight line through the middle, over which no line is shorter than another
    said = refusal(
        tmp_path, BODIES + text.replace("AT", "[-0.22, 0.6, -0.05]").replace("SURFACE", "ball")
    )
    assert "no shortest line over it" in said
    said = refusal(tmp_path, BODIES + text.replace("AT", "[0, 1, 0]").replace("SURFACE", "box"))
    assert "a belt lies on one of sphere, cylinder, ellipsoid" in said


def test_a_side_of_a_cylinder_that_is_none_is_refused(tmp_path: Path) -> None:
    bodies = BODIES.replace(
        "position: [-0.06, 0, 0]\n    rotation: {axis: [1, 2, 3], angle: 0.4}",
        "position: [0.1, 0, 0]",
    )
    text = (
        "belts:\n  s:\n    webbing: {stiffness: 1e5}\n    route:\n"
        "      - {anchor: {at: [0.1, 1, 0]}}\n      - {wrap: {surface: rollOVER}}\n"
        "      - {anchor: {body: a}}\n"
    )
    said = refusal(tmp_path, bodies + text.replace("OVER", ""))
    assert "opposite each other: give over" in said and "deck.yaml:" in said
    said = refusal(tmp_path, bodies + text.replace("OVER", ", over: [0, 0, 0.3]"))
    assert "on the axis of the cylinder" in said and "deck.yaml:" in said


@pytest.mark.parametrize("surface", ["ball", "egg", "roll"])
def test_a_belt_that_slips_off_a_shape_is_reported(tmp_path: Path, surface: str) -> None:
    law = belt(tmp_path, surface, 0.3)
    said = []
    # the body goes through the belt: a roll takes it along, a ball and a fist do not
    x = np.linspace(-0.05, 0.35, 81)
    for at in x:
        law.bench.move(2, r=[at, 0.0, 0.0])
        law.force(1e-3)
        law.accept()
        said.append(bool(law.new.crossed or law.new.slipped))
        assert np.isfinite(np.array(law.out.force)).all()
    # it is said until the end
    assert not said[0] and said[-1] == (surface != "roll")
    if surface == "ball":
        # the line from end to end passes the ball's middle where that is at 0.05 m, 25 mm from it
        assert abs(x[said.index(True)] - 0.05) < 0.025


def test_a_ball_that_rolls_along_under_its_belt_has_not_slipped(tmp_path: Path) -> None:
    law = belt(tmp_path, "ball", 0.0)
    for angle in np.linspace(0.0, 6.0, 61):
        law.bench.move(2, r=[-0.05, 0.0, 0.0], q=[np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])
        law.force(1e-3)
        law.accept()
    # the belt is not quite in the plane of the rotation: some slip, and not the six radians
    assert abs(law.new.lateral[0]) < 0.6 and law.new.crossed == 0


@pytest.mark.parametrize("surface", ["ball", "egg", "roll"])
@pytest.mark.parametrize("beyond", [-1.0, 0.7])
def test_a_belt_that_passes_a_surface_behind_its_end_is_a_straight_belt(
    tmp_path: Path, surface: str, beyond: float
) -> None:
    # the nearest point of the line to the surface is an end of it: no segment has no length
    law = belt(tmp_path, surface, 0.3, slack=-0.2)
    law.bench.move(2, r=[0.0, beyond, 0.0])
    law.force(1e-3)
    straight = np.linalg.norm([0.1, -1.2, 0.05])
    assert law.out.length[0] + law.out.length[1] == pytest.approx(straight, rel=1e-12)
    assert min(law.out.length[0], law.out.length[1]) > 0.05
    tension = 1e5 * (straight / law.p.total - 1.0)
    np.testing.assert_allclose(law.out.force[:2], tension, rtol=1e-9)
    assert law.new.short == 0


@pytest.mark.parametrize("surface", ["ball", "egg", "roll"])
def test_a_belt_that_comes_out_of_a_body_is_straight_until_it_is_clear_of_it(
    tmp_path: Path, surface: str
) -> None:
    law = belt(tmp_path, surface, 0.3, slack=0.0, at=(0.5, 0.6, 0))
    # an anchor goes through the body to its far side, and back around it
    path = [[0.1, -0.6, 0.05], [-0.06, 0.0, 0.0], [-0.5, -0.3, 0.0], [0.3, -0.7, 0.0]]
    touches = []
    for start, end in zip(path[:-1], path[1:], strict=True):
        for share in np.linspace(0.02, 1.0, 50):
            law.bench.move(1, r=np.add(start, share * np.subtract(end, start)))
            law.force(1e-3)
            touches.append(int(law.new.touches[0]))
            straight = np.linalg.norm(np.subtract(law.bench.nodes[1].r, [0.5, 0.6, 0.0]))
            if touches[-1] < 0:
                both = law.out.length[0] + law.out.length[1]
                assert both == pytest.approx(straight, rel=1e-12)
            law.accept()
    assert law.new.inside == 1 and min(touches) == -1 and touches[-1] >= 0
    # it does not lie on it at once, with all of an arc
    assert (-1, 1) not in zip(touches[:-1], touches[1:], strict=True)


def test_surfaces_that_are_not_side_by_side_have_rows_of_their_own() -> None:
    inner = range(1, FITTINGS - 1)
    assert {surface_row(j) for j in inner} == set(range(SURFACES))
    assert all(surface_row(i) != surface_row(j) for i in inner for j in inner if j > i + 1)
