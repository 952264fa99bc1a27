"""Belts over needles, discs and flat shapes, hooks, several turns, and what slipping off loses."""

from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Law
from quick import first_quick
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipeinc

from crashsolve.belts._arc import Arc
from crashsolve.belts._ellipsoid import over_ellipsoid
from crashsolve.belts._geodesic import pieces_of, tangent_ray, trace

NEW = (0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
SHAPES = [
    (1.0, 1.0, 20.0),  # needle
    (1.0, 1.0, 0.05),  # disc
    (1.0, 5.0, 20.0),
    (1.0, 0.2, 0.05),
    (0.3, 0.2, 0.25),
]


def pair_of_points(semi: tuple[float, ...], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Two points on about opposite sides, some of them near."""
    rng = np.random.default_rng(seed)
    u = rng.normal(size=3)
    v = -u / np.linalg.norm(u) + 0.4 * rng.normal(size=3)
    near = 1.05 + 2.0 * rng.random(2)
    A = np.array(semi) * u / np.linalg.norm(u) * near[0]
    return A, np.array(semi) * v / np.linalg.norm(v) * near[1]


def exact_ray(semi: tuple[float, ...], x: np.ndarray, t: np.ndarray, s: float) -> np.ndarray:
    """Point, direction and bend of a geodesic after s, by an independent integration."""
    H = 1.0 / np.array(semi) ** 2

    def derivative(_: float, y: np.ndarray) -> np.ndarray:
        g = H * y[:3]
        curved = -(y[3:6] @ (H * y[3:6])) / (g @ g) * g
        return np.r_[y[3:6], curved, np.linalg.norm(curved)]

    start = np.r_[x, t, 0.0]
    done = solve_ivp(derivative, (0, s), start, method="DOP853", rtol=1e-11, atol=1e-13)
    return done.y[:, -1]


@pytest.mark.parametrize("semi", first_quick([pytest.param(semi) for semi in SHAPES], 2))
@pytest.mark.parametrize("seed", range(3))
def test_the_arc_is_a_geodesic_that_leaves_to_both_points(
    semi: tuple[float, ...], seed: int
) -> None:
    A, B = pair_of_points(semi, seed)
    arc = over_ellipsoid(semi, tuple(A), tuple(B), NEW)
    assert arc.touches == 1
    first = np.array(arc.first)
    t = (first - A) / np.linalg.norm(first - A)
    end = exact_ray(semi, first, t, arc.length)
    # steps of fourth order over a rim that is 20 times thinner than wide: 1e-5
    close = 2e-5 * arc.length
    np.testing.assert_allclose(arc.last, end[:3], atol=close)
    assert arc.bend == pytest.approx(end[6], abs=2e-5)
    middle = exact_ray(semi, first, t, 0.5 * arc.length)
    np.testing.assert_allclose(arc.middle, middle[:3], atol=close)
    # it leaves along its tangent towards B, not away from it
    leaves = B - end[:3]
    np.testing.assert_allclose(leaves / np.linalg.norm(leaves), end[3:6], atol=2e-5)


@pytest.mark.parametrize("semi", SHAPES)
def test_neighbours_of_a_ray_are_as_far_as_its_spread(semi: tuple[float, ...]) -> None:
    A, B = pair_of_points(semi, 1)
    a = A / semi
    e = np.cross(a, B / semi)
    e /= np.linalg.norm(e)
    f = np.cross(a, e) / np.linalg.norm(a)
    tau, small = 1.5, 1e-6
    ends, lengths = [], []
    for psi in (0.3 - small, 0.3, 0.3 + small):
        first, by_psi = tangent_ray(semi, tuple(A), tuple(a), tuple(e), tuple(f), psi)
        last, _ = trace(semi, first, tau, 4 * pieces_of(semi, tau))
        ends.append(last)
        lengths.append(last.length)
    g = np.array(ends[1].x) / np.array(semi) ** 2
    across = np.cross(g / np.linalg.norm(g), ends[1].t)
    apart = (np.array(ends[2].x) - np.array(ends[0].x)) @ across / (2.0 * small)
    # of differences of 1e-6
    assert apart == pytest.approx(ends[1].spread * by_psi, rel=1e-5, abs=1e-6 * max(semi))


def length_over(arc: Arc, A: np.ndarray, B: np.ndarray) -> float:
    straight = np.linalg.norm(A - arc.first) + np.linalg.norm(B - arc.last)
    return float(straight + arc.length)


def in_plane(a: float, b: float, A: np.ndarray, B: np.ndarray) -> float:
    """Length around the upper side of an ellipse from A to B, to the left and right of it."""

    def tangency(P: np.ndarray, sign: float) -> float:
        """Parameter of the ellipse (a cos, b sin) whose tangent meets P."""
        size = np.hypot(P[0] / a, P[1] / b)
        return float(np.arctan2(P[1] / b, P[0] / a) + sign * np.arccos(1.0 / size))

    def arc_to(u: float) -> float:
        # ds^2 = a^2 sin^2 + b^2 cos^2 = b^2 (1 - (1 - a^2/b^2) sin^2)
        return float(b * ellipeinc(u, 1.0 - (a / b) ** 2))

    u_A, u_B = tangency(A, -1.0), tangency(B, 1.0)
    ends = [np.array([a * np.cos(u), b * np.sin(u)]) for u in (u_A, u_B)]
    straight = np.linalg.norm(A - ends[0]) + np.linalg.norm(B - ends[1])
    return float(straight + arc_to(u_A) - arc_to(u_B))


@pytest.mark.parametrize("b", first_quick([0.05, 3.0, 0.5, 1.0], 2))
@pytest.mark.parametrize("far", [1.3, 4.0])
def test_over_a_long_ridge_the_length_is_that_around_an_ellipse(b: float, far: float) -> None:
    """A belt across the middle of a shape so long that it does not slip off sideways."""
    A, B = np.array([-far, 0.1]), np.array([far, -0.05])
    arc = over_ellipsoid((1.0, b, 60.0), (*A, 0.0), (*B, 0.0), NEW)
    assert arc.touches == 1 and arc.middle[1] > 0.0
    length = length_over(arc, np.array([*A, 0.0]), np.array([*B, 0.0]))
    assert length == pytest.approx(in_plane(1.0, b, A, B), rel=1e-6)


BODIES = """
title: belt over a bar
control: {end_time: 1}
bodies:
  a: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [-0.02, 0.14, 0]}
  b: {mass: 2, inertia: [0.5, 0.6, 0.4], position: [-0.02, -0.14, 0]}
  roll: {mass: 2, inertia: [0.5, 0.6, 0.4]}
surfaces:
  reel: {type: cylinder, body: roll, axis: [0, 0, 1], radius: 0.1, length: 1}
  egg: {type: ellipsoid, body: roll, semi_axes: [0.1, 0.1, 2]}
  bar: {type: ellipsoid, semi_axes: [0.1, 0.1, 2]}
  fist: {type: ellipsoid, semi_axes: [0.1, 0.1, 0.12]}
  drum: {type: cylinder, axis: [0, 0, 1], radius: 0.1, length: 1}
"""


def belt(folder: Path, surface: str, mu: float, slack: float) -> Law:
    text = (
        f"belts:\n  s:\n    webbing: {{stiffness: 4e4}}\n    slack: {slack}\n    route:\n"
        f"      - {{anchor: {{body: b}}}}\n"
        f"      - {{wrap: {{surface: {surface}, friction_coefficient: {mu}OVER}}}}\n"
        "      - {anchor: {body: a}}\n"
    ).replace("OVER", ", over: [-1, 0, 0]" if surface in ("drum", "reel") else "")
    return Bench(folder, text, BODIES).law("belts", "s")


def hook_length(x: float) -> float:
    """Around the back of a circle of radius 0.1 from points at x in front of its middle."""
    far = np.hypot(x, 0.14)
    tangents = np.sqrt(far**2 - 0.01)
    angle = 2.0 * (np.pi - np.arctan2(0.14, x) - np.arccos(0.1 / far))
    return float(2.0 * tangents + 0.1 * angle)


@pytest.mark.parametrize("surface", ["bar", "drum"])
def test_a_belt_around_the_back_of_a_bar_stays_there(tmp_path: Path, surface: str) -> None:
    """Its length is that of the hook, also as the line between its ends leaves the bar in front."""
    law = belt(tmp_path, surface, 0.2, 0.0)
    for x in [*np.linspace(-0.02, 0.3, 33), *np.linspace(0.3, -0.02, 33)]:
        for node, y in ((1, 0.14), (2, -0.14)):
            law.bench.move(node, r=[x, y, 0.0])
        law.force(1e-3)
        length = float(law.out.length[0] + law.out.length[1])
        assert length == pytest.approx(hook_length(x), rel=1e-6), x
        law.accept()
    assert law.new.slipped == 0 and law.new.crossed == 0


def test_a_belt_that_slips_off_loses_what_it_stored_and_no_more(tmp_path: Path) -> None:
    law, work, lost = belt(tmp_path, "fist", 0.2, 0.0), 0.0, 0.0
    T, length, largest = np.zeros(2), np.array(law.old.straight[:2]), 0.0
    for x in np.linspace(-0.02, 0.3, 641):
        for node, y in ((1, 0.14), (2, -0.14)):
            law.bench.move(node, r=[x, y, 0.0])
        law.force(1e-4)
        now = np.array(law.out.length[:2])
        if law.new.touches[0] >= 0:
            work += float(0.5 * (T + law.out.force[:2]) @ (now - length))
        T, length = np.array(law.out.force[:2]), now
        lost += float(law.out.loss)
        largest = max(largest, float(law.out.stored))
        law.accept()
    assert law.new.slipped == 1 and law.out.stored == 0.0 and largest > 100.0
    # all work is lost at the end; the step in which it slips moves the ends by 0.5 mm, of 0.1 m
    assert lost == pytest.approx(work, rel=1e-2)


@pytest.mark.parametrize("rounds", [-6.0, -2.0, 0.7, 6.0])
def test_a_winch_has_the_length_and_friction_of_all_of_its_turns(
    tmp_path: Path, rounds: float
) -> None:
    """Wound further, or unwound and then wound on the other side."""
    far, mu = np.hypot(0.02, 0.14), 0.05
    between = abs(2.0 * np.pi * (1.0 + rounds) - 2.0 * np.arctan2(0.14, -0.02))
    added = between - 2.0 * (np.pi - np.arctan2(0.14, -0.02))
    # as long as it is when it is wound, so that it is drawn out alone
    law = belt(tmp_path, "drum", mu, 0.1 * added)
    angles = np.arctan2(0.14, -0.02) - np.linspace(0.0, 2.0 * np.pi * rounds, 100)
    for angle in angles:
        law.bench.move(1, r=[far * np.cos(angle), far * np.sin(angle), 0.0])
        law.force(1e-3)
        law.accept()
    # drawn outwards, all of it slides
    out = np.array([np.cos(angles[-1]), np.sin(angles[-1]), 0.0])
    for d in np.linspace(0.0, 0.2, 20):
        law.bench.move(1, r=(far + d) * out)
        law.force(1e-3)
        law.accept()
    wrapped = between - np.arccos(0.1 / far) - np.arccos(0.1 / (far + 0.2))
    assert law.out.angle[1] == pytest.approx(wrapped, rel=1e-9)
    length = float(law.out.length[0] + law.out.length[1])
    tangents = np.sqrt(far**2 - 0.01) + np.sqrt((far + 0.2) ** 2 - 0.01)
    assert length == pytest.approx(tangents + 0.1 * wrapped, rel=1e-9)
    high, low = max(law.out.force[:2]), min(law.out.force[:2])
    assert high == pytest.approx(low * np.exp(mu * wrapped), rel=1e-8)


@pytest.mark.parametrize("surface", ["reel", "egg"])
@pytest.mark.parametrize("spin", [-40.0, 40.0])
def test_a_roll_that_rotates_under_its_belt_drags_it_with_the_friction_of_its_angle(
    tmp_path: Path, surface: str, spin: float
) -> None:
    """For some turns, of which each would have drawn a segment of 0.1 m to nothing."""
    law, mu, h, work, lost = belt(tmp_path, surface, 0.3, -0.02), 0.3, 1e-3, 0.0, 0.0
    law.force(0.0)
    total = float(law.p.total)
    law.bench.move(3, w=[0.0, 0.0, spin])
    before = law.power_on_bodies()
    for k in range(400):
        if k == 100:
            # it slides in all of a step from here on
            first, work, lost = float(law.out.stored), 0.0, 0.0
        law.bench.drift(h)
        law.force(h)
        now = law.power_on_bodies()
        work += 0.5 * h * (before + now)
        lost += float(law.out.loss)
        before = now
        assert law.new.webbing[:2].sum() == pytest.approx(total, rel=1e-12)
        law.accept()
    arc = 0.1 * float(law.out.angle[1])
    leg = 0.5 * (hook_length(-0.02) - arc)
    c = np.exp(mu * law.out.angle[1])

    def missing(low: float) -> float:
        """Webbing on both sides at the force `low`; the end of the arc divides it."""
        sides = (leg, low, leg + arc, c * low)
        return sides[0] / (1.0 + sides[1] / 4e4) + sides[2] / (1.0 + sides[3] / 4e4) - total

    low = brentq(missing, 1.0, 1e5, rtol=1e-12)
    forces = sorted(law.out.force[:2])
    # the steps of the ellipsoid know its arc to 1e-7
    np.testing.assert_allclose(forces, [low, c * low], rtol=1e-5)
    power = (c - 1.0) * low * 0.1 * abs(spin)
    assert before == pytest.approx(-power, rel=1e-5)
    # steps of 0.04 rad, of which the motion of the surface is known to phi^2 / 6
    closes = work + lost + float(law.out.stored) - first
    assert closes == pytest.approx(0.0, abs=1.1 * (spin * h) ** 2 / 6.0 * lost)
    assert law.new.short == 0
