"""Claim: a hinge follows its curve, loses the area of its loops, and knows turning points only.

The kernels are called with angles; the models they are compared with are written here in other
terms: envelopes over the angle instead of a slider over the plastic angle.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from bench import Bench
from quick import first_quick

from crashsolve.hinges import _joint, _law, _pair

ELASTIC = 1000.0
# rises, hardens, softens ten times as steeply, ends level; another one for negative angles
POINTS = [[0, 0], [0.01, 10], [0.05, 14], [0.06, 4], [0.2, 2]]
OTHER = [[0, 0], [0.02, 20], [0.1, 22]]
CURVES = f"""
curves:
  up: {{points: {POINTS}, extrapolate: hold}}
  down: {{points: {OTHER}, extrapolate: hold}}
  perfect: {{points: [[0, 0], [0.01, 10], [0.1, 10]], extrapolate: hold}}
  bilinear: {{points: [[0, 0], [0.01, 10], [1, 109]], extrapolate: hold}}
  smooth: {{points: [[0, 0], [0.01, 6], [0.03, 10], [0.1, 8]], interpolation: smooth,
            extrapolate: hold}}
"""
HINGE = "type: bending, a: a, b: b, at: [0, 0, 0], axis: [0, 0, 1]"
Walk = Callable[[Sequence[float] | np.ndarray], np.ndarray]
# of a curve: angle and moment of each
Points = Sequence[Sequence[float]]


class Driven:
    """A hinge led along angles by its kernel; keeps moment, stored energy and loss."""

    def __init__(self, folder: Path, words: str, extra: str = "") -> None:
        text = f"{CURVES}{extra}hinges:\n  h: {{{HINGE}, {words}}}\n"
        self.law = Bench(folder, text).law("hinges", "h")
        self.moment = self.stored = self.lost = 0.0

    def go(self, angle: float, phi: float = 1.0) -> float:
        law = self.law
        curves = law.bench.curves
        outcome = _law.advance_motion(law.p, law.old, law.new, 0, angle, phi, curves)
        self.moment, self.stored, loss = map(float, outcome)
        self.lost += loss
        law.new.factor = phi
        law.accept()
        return self.moment

    def walk(self, angles: Sequence[float] | np.ndarray) -> np.ndarray:
        return np.array([self.go(float(angle)) for angle in angles])


def read(points: Points, angle: float) -> float:
    return float(np.interp(angle, *np.transpose(points)))


class Isotropic:
    """The curve over alpha + M / k: yield level follows the sum of plastic angles."""

    def __init__(self, up: Points, down: Points) -> None:
        self.sides, self.alpha, self.x, self.M = (up, down), 0.0, 0.0, 0.0

    def go(self, angle: float) -> float:
        trial = self.M + ELASTIC * (angle - self.x)
        reached = self.alpha + abs(trial) / ELASTIC
        limit = read(self.sides[0 if trial > 0 else 1], reached)
        if abs(trial) > limit:
            self.alpha, trial = reached - limit / ELASTIC, np.copysign(limit, trial)
        self.x, self.M = angle, trial
        return trial


class Kinematic:
    """Between two envelopes, each the curve on one side and its mirror image on the other."""

    def __init__(self, up: Points, down: Points) -> None:
        self.sides, self.x, self.M = (up, down), 0.0, 0.0
        self.first = up[1][1], down[1][1]

    def envelope(self, angle: float, side: int) -> float:
        """Largest moment in the direction `side` (0, 1) at an angle that grows in it."""
        own, other = self.sides[side], self.sides[1 - side]
        if angle >= self.first[side] / ELASTIC:
            return read(own, angle)
        both = sum(self.first)
        return both - read(other, both / ELASTIC - angle)

    def go(self, angle: float) -> float:
        trial = self.M + ELASTIC * (angle - self.x)
        high, low = self.envelope(angle, 0), -self.envelope(-angle, 1)
        self.x, self.M = angle, min(max(trial, low), high)
        return self.M


class PeakOriented:
    """Straight lines in the plane of angle and moment, from corner to corner."""

    def __init__(self, up: Points, down: Points) -> None:
        self.sides, self.x, self.M, self.zero = (up, down), 0.0, 0.0, 0.0
        self.peak = [[up[1][0], up[1][1]], [down[1][0], down[1][1]]]

    def go(self, angle: float) -> float:
        side = 0 if angle > self.x else 1
        sign = 1.0 - 2.0 * side
        x, M, end = sign * self.x, sign * self.M, sign * angle
        if M < 0.0:
            # up to where the moment changes its sign, on the elastic line
            cross = x - M / ELASTIC
            if end <= cross:
                self.x, self.M = angle, sign * (M + ELASTIC * (end - x))
                return self.M
            x, M, self.zero = cross, 0.0, cross
        elif M == 0.0:
            self.zero = x
        peak = self.peak[side]
        elastic = M + ELASTIC * (end - x)
        if end <= peak[0] and peak[0] > self.zero:
            bound = peak[1] * (end - self.zero) / (peak[0] - self.zero)
        else:
            bound = read(self.sides[side], end)
        if elastic > bound:
            elastic = bound
            if end > peak[0]:
                self.peak[side] = [end, bound]
        self.x, self.M = angle, sign * elastic
        return self.M


def test_one_way_is_the_curve(tmp_path: Path) -> None:
    angles = np.linspace(0.001, 0.3, 173)
    for cyclic in ("isotropic", "peak_oriented"):
        hinge = Driven(tmp_path, f"curve: up, cyclic: {cyclic}")
        # sums of a few products: round-off of 14 N m
        np.testing.assert_allclose(
            hinge.walk(angles), np.interp(angles, *np.transpose(POINTS)), atol=1e-12
        )
        hinge = Driven(tmp_path, f"curve: up, curve_negative: down, cyclic: {cyclic}")
        np.testing.assert_allclose(
            hinge.walk(-angles), -np.interp(angles, *np.transpose(OTHER)), atol=1e-12
        )


def test_a_curve_that_bends_is_followed_by_chords(tmp_path: Path) -> None:
    hinge = Driven(tmp_path, "curve: smooth, stiffness: 1500")
    law, start = hinge.law, hinge.law.bench.model.curve_names["smooth"]
    angles = np.linspace(0.0, 0.1, 57)
    wanted = [_law.curve_value(law.bench.curves, start, x)[0] for x in angles]
    # 64 chords a piece, of which each turns by less than its slope
    np.testing.assert_allclose(hinge.walk(angles), wanted, atol=2e-3)


WALKS = {
    "isotropic": ("curve: up, curve_negative: down", Isotropic, POINTS, OTHER),
    "kinematic": (
        "curve: bilinear, curve_negative: down",
        Kinematic,
        [[0, 0], [0.01, 10], [1, 109]],
        OTHER,
    ),
    "peak_oriented": ("curve: up, curve_negative: down", PeakOriented, POINTS, OTHER),
}


@pytest.mark.parametrize("cyclic", list(WALKS))
@pytest.mark.parametrize("seed", first_quick(range(4), 2))
def test_a_random_walk_follows_an_independent_model(tmp_path: Path, cyclic: str, seed: int) -> None:
    words, model, up, down = WALKS[cyclic]
    hinge, other = Driven(tmp_path, f"{words}, cyclic: {cyclic}"), model(up, down)
    rng = np.random.default_rng(seed)
    angles = np.cumsum(rng.normal(scale=0.02, size=300))
    moments, wanted = hinge.walk(angles), np.array([other.go(float(x)) for x in angles])
    assert np.abs(moments).max() > 5.0
    # 300 steps of round-off of 20 N m
    np.testing.assert_allclose(moments, wanted, atol=1e-10)


class Lifted:
    """A slider found by halving: k (x - x_p) = phi R, with R of each law in its own words."""

    def __init__(self, cyclic: str, up: Points, down: Points) -> None:
        self.sides = [(p[:, 0] - p[:, 1] / ELASTIC, p[:, 1]) for p in map(np.array, (up, down))]
        self.cyclic, self.x, self.alpha, self.M = cyclic, 0.0, 0.0, 0.0
        self.zero, self.peak = 0.0, [0.0, 0.0]

    def curve(self, side: int, x: float) -> float:
        # the points of the elastic line all have x = 0
        return float(np.interp(x, self.sides[side][0][1:], self.sides[side][1][1:]))

    def resists(self, side: int, direction: float) -> float:
        at = (1 - 2 * side) * self.x + direction
        if self.cyclic == "isotropic":
            return self.curve(side, self.alpha + direction)
        if self.cyclic == "kinematic":
            both = self.sides[side][1][1] + self.sides[1 - side][1][1]
            return self.curve(side, at) if at >= 0.0 else both - self.curve(1 - side, -at)
        if at >= self.peak[side]:
            return self.curve(side, at)
        zero = (1 - 2 * side) * self.zero
        return self.curve(side, self.peak[side]) * (at - zero) / (self.peak[side] - zero)

    def go(self, angle: float, phi: float) -> float:
        for side, sign in ((0, 1.0), (1, -1.0)):
            if self.cyclic == "peak_oriented" and sign * self.M <= 0.0:
                before, self.zero = self.zero, self.x
            else:
                before = self.zero

            def left(direction: float, side: int = side, sign: float = sign) -> float:
                R = self.resists(side, direction)
                elastic = sign * ELASTIC * (angle - self.x) - ELASTIC * direction
                return elastic - (phi * R if R > 0.0 else R)

            pulls = self.cyclic == "kinematic" or sign * (angle - self.x) > 0.0
            if pulls and left(0.0) > 1e-9:
                low, high = 0.0, abs(angle - self.x) + 1.0
                for _ in range(80):
                    middle = 0.5 * (low + high)
                    low, high = (middle, high) if left(middle) > 0.0 else (low, middle)
                self.x, self.alpha = self.x + sign * low, self.alpha + low
                self.peak[side] = max(self.peak[side], sign * self.x)
                break
            self.zero = before
        self.M = ELASTIC * (angle - self.x)
        return self.M


@pytest.mark.parametrize("cyclic", list(WALKS))
@pytest.mark.parametrize("seed", first_quick(range(3)))
def test_a_random_walk_with_growth_follows_an_independent_model(
    tmp_path: Path, cyclic: str, seed: int
) -> None:
    up = OTHER if cyclic == "kinematic" else [[0, 0], [0.01, 10], [0.05, 14], [0.2, 16]]
    points = [[float(x), float(y)] for x, y in up]
    text = f"curve: walk, cyclic: {cyclic}"
    rng = np.random.default_rng(seed)
    walk = 0.02 * np.cumsum(rng.normal(size=60))
    factors = 1.0 + rng.uniform(0.0, 0.6, size=60)
    hinge = Driven(tmp_path, text, extra=f"  walk: {{points: {points}, extrapolate: hold}}\n")
    model = Lifted(cyclic, points, points)
    for angle, phi in zip(walk, factors, strict=True):
        wanted = model.go(float(angle), float(phi))
        # 80 halvings of 1 rad, times the stiffness
        assert hinge.go(float(angle), float(phi)) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("cyclic", list(WALKS))
def test_steps_between_turning_points_do_not_matter(tmp_path: Path, cyclic: str) -> None:
    words = f"{WALKS[cyclic][0]}, cyclic: {cyclic}"
    rotations = [0.07, -0.03, 0.04, 0.02, 0.12, -0.15, 0.0, 0.2]
    coarse, fine = Driven(tmp_path, words), Driven(tmp_path, words)
    for before, after in zip([0.0, *rotations[:-1]], rotations, strict=True):
        coarse.go(after)
        fine.walk(np.linspace(before, after, 38)[1:])
        assert fine.moment == pytest.approx(coarse.moment, abs=1e-12)
        assert fine.lost == pytest.approx(coarse.lost, abs=1e-12)
        assert fine.stored == pytest.approx(coarse.stored, abs=1e-12)


@pytest.mark.parametrize("cyclic", list(WALKS))
@pytest.mark.parametrize("seed", first_quick(range(3)))
def test_work_is_stored_and_dissipated(tmp_path: Path, cyclic: str, seed: int) -> None:
    """By trapezoids over many steps; each corner is missed by k d^2 / 8 at most."""
    hinge = Driven(tmp_path, f"{WALKS[cyclic][0]}, cyclic: {cyclic}")
    rotations = np.concatenate([[0.0], np.random.default_rng(seed).normal(scale=0.08, size=12)])
    work = corners = before = 0.0
    for start, end in zip(rotations[:-1], rotations[1:], strict=True):
        angles = np.linspace(start, end, 401)
        moments = np.concatenate([[before], hinge.walk(angles[1:])])
        work += float(np.diff(angles) @ (moments[1:] + moments[:-1])) / 2.0
        corners += 6.0 * ELASTIC * (angles[1] - angles[0]) ** 2 / 8.0
        before = moments[-1]
    assert hinge.lost > 0.1
    assert work == pytest.approx(hinge.stored + hinge.lost, abs=corners)


def test_loops_lose_their_area_to_round_off(tmp_path: Path) -> None:
    """Parallelograms: 4 M_y (x - M_y / k) where perfect, width 2 M_y / k less where it moves."""
    perfect = Driven(tmp_path, "curve: perfect")
    perfect.walk([0.05, -0.05])
    start = perfect.stored + perfect.lost
    perfect.walk([0.05, -0.05])
    assert perfect.stored + perfect.lost - start == pytest.approx(4 * 10 * (0.05 - 0.01), rel=1e-14)
    moving = Driven(tmp_path, "curve: bilinear, cyclic: kinematic")
    moving.walk([0.11, -0.11])
    start = moving.stored + moving.lost
    moving.walk([0.11, -0.11])
    # yield after 20 N m = 0.02 rad on the way back; the sides are 0.2 rad long in x, 20 N m apart
    # along the moment less the slope 100 of hardening over the same 0.02 rad
    area = (0.22 - 0.02) * (20 - 100 * 0.02)
    assert moving.stored + moving.lost - start == pytest.approx(area, rel=1e-13)
    oriented = Driven(tmp_path, "curve: up, cyclic: peak_oriented")
    oriented.walk([0.06, 0.0, -0.01, 0.06])
    # area under the curve to 0.06 rad
    under = 0.05 + 0.04 * 12 + 0.01 * 9
    # from 4 N m back to 0 at 0.056 rad, to (-0.01, -10), to 0 at 0 rad, to (0.06, 4)
    back = -0.5 * 4 * 0.004 + 0.5 * 10 * 0.066 - 0.5 * 10 * 0.01 + 0.5 * 4 * 0.06
    assert oriented.stored + oriented.lost == pytest.approx(under + back, rel=1e-13)


@pytest.mark.parametrize("cyclic", list(WALKS))
def test_unloading_is_elastic_and_leaves_the_residual_angle(tmp_path: Path, cyclic: str) -> None:
    hinge = Driven(tmp_path, f"{WALKS[cyclic][0]}, cyclic: {cyclic}")
    top = hinge.go(0.04)
    assert hinge.go(0.039) == pytest.approx(top - 1.0, rel=1e-12)
    residual = float(hinge.law.old.plastic[0])
    assert residual == pytest.approx(0.04 - top / ELASTIC, rel=1e-12)
    assert hinge.go(residual) == pytest.approx(0.0, abs=1e-12)


def test_the_loss_never_falls(tmp_path: Path) -> None:
    for cyclic, (words, *_) in WALKS.items():
        hinge = Driven(tmp_path, f"{words}, cyclic: {cyclic}")
        rng, before = np.random.default_rng(7), 0.0
        for angle in np.cumsum(rng.normal(scale=0.02, size=300)):
            hinge.go(float(angle))
            # round-off of 10 J
            assert hinge.lost >= before - 1e-14
            before = hinge.lost


def lifted(points: Points, phi: float) -> list[list[float]]:
    """The curve whose yield moments at the same plastic angles are phi times as large."""
    return [[x + (phi - 1.0) * y / ELASTIC, phi * y] for x, y in points]


@pytest.mark.parametrize("cyclic", ["isotropic", "peak_oriented"])
@pytest.mark.parametrize(("name", "points", "phi"), [("up", POINTS, 1.6), ("down", OTHER, 21.0)])
def test_a_factor_multiplies_yield_and_leaves_the_elastic_line(
    tmp_path: Path, cyclic: str, name: str, points: Points, phi: float
) -> None:
    hinge = Driven(tmp_path, f"curve: {name}, cyclic: {cyclic}")
    steep = f"curves:\n  more: {{points: {lifted(points, phi)}, extrapolate: hold}}\n"
    text = f"{steep}hinges:\n  h: {{{HINGE}, curve: more, cyclic: {cyclic}}}\n"
    other = Driven(tmp_path, "curve: up")
    other.law = Bench(tmp_path, text).law("hinges", "h")
    rng = np.random.default_rng(5)
    for angle in np.cumsum(rng.normal(scale=0.05, size=200)):
        moment = hinge.go(float(angle), phi)
        # 200 steps of round-off of 300 N m
        assert moment == pytest.approx(other.go(float(angle)), abs=1e-9)
    assert hinge.lost == pytest.approx(other.lost, rel=1e-9)


def test_a_factor_that_makes_softening_too_steep_still_has_an_answer(tmp_path: Path) -> None:
    """phi times the fall is steeper than the elastic line: the moment drops at once, to phi y."""
    hinge = Driven(tmp_path, "curve: up")
    for angle in np.linspace(0.0, 1.0, 301)[1:]:
        moment = hinge.go(float(angle), 21.0)
        x = float(hinge.law.old.plastic[0])
        wanted = 21.0 * np.interp(x, [0, 0.036, 0.056, 0.198], [10, 14, 4, 2])
        assert moment <= wanted + 1e-9
        assert moment == pytest.approx(wanted, abs=1e-9) or moment == pytest.approx(1000 * angle)


BIAXIAL = "type: biaxial, a: a, b: b, at: [0, 0, 0], axis: [1, 0, 0], side: [0, 1, 0]"


class Rotated:
    """A hinge in two directions, led along two angles by its kernel."""

    def __init__(self, folder: Path, words: str) -> None:
        text = f"{CURVES}hinges:\n  h: {{{BIAXIAL}, {words}}}\n"
        self.law, self.lost = Bench(folder, text).law("hinges", "h"), 0.0
        self.moment, self.stored = np.zeros(2), 0.0

    def go(self, x: float, y: float) -> np.ndarray:
        law = self.law
        _joint.copy_history(law.old, law.new)
        outcome = _pair.advance_pair(law.p, law.old, law.new, x, y, 1.0, law.bench.curves)
        self.moment, self.stored = np.array(outcome[:2], float), float(outcome[2])
        self.lost += float(outcome[3])
        law.accept()
        return self.moment


@pytest.mark.long
def test_a_load_that_turns_stays_on_the_ellipse(tmp_path: Path) -> None:
    hinge = Rotated(tmp_path, "curve: perfect, second_curve: down, second_stiffness: 1000")
    moments = [
        hinge.go(0.05 * a * np.cos(a), 0.05 * a * np.sin(a)) for a in np.linspace(0, 12, 160)
    ]
    # the second curve hardens: its present yield moment is that at the work done
    work = float(hinge.law.old.flow_work)
    flown = np.interp(work, [0, 0.5 * 42 * (0.078), 1e9], [20, 22, 22])
    late = np.array(moments[80:])
    assert (np.hypot(late[:, 0] / 10.0, late[:, 1] / flown) < 1.0 + 1e-6).all()
    assert (np.hypot(late[:, 0] / 10.0, late[:, 1] / flown) > 0.999).all()


@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_a_round_section_is_alike_in_all_directions(tmp_path: Path, angle: float) -> None:
    hinge, plane = Rotated(tmp_path, "curve: up"), Driven(tmp_path, "curve: up")
    direction = np.array([np.cos(angle), np.sin(angle)])
    for x in (0.005, 0.03, 0.055, 0.08, -0.03):
        wanted = plane.go(x)
        # pieces of a step return each to the curve at its end, where it is exact
        np.testing.assert_allclose(hinge.go(*(x * direction)), wanted * direction, atol=2e-2)


def test_the_error_on_the_ellipse_is_of_first_order(tmp_path: Path) -> None:
    """A quarter turn at constant radius in steps of one piece; the limit by eight times as many."""
    moments = {}
    for count in (60, 120, 240, 1920):
        hinge = Rotated(tmp_path, "curve: perfect, second_curve: down, second_stiffness: 1000")
        for a in np.linspace(0.0, np.pi / 2, count + 1):
            hinge.go(0.03 * np.cos(a), 0.03 * np.sin(a))
        moments[count] = hinge.moment
    errors = [np.abs(moments[count] - moments[1920]).max() for count in (60, 120, 240)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 0.8) & (orders < 1.6)).all()


@pytest.mark.parametrize("onward", [(1.0, 0.4), (0.2, 1.0), (-1.0, -0.3)])
def test_the_tangent_on_the_ellipse_is_the_derivative(
    tmp_path: Path, onward: tuple[float, float]
) -> None:
    hinge = Rotated(tmp_path, "curve: bilinear, second_curve: down, second_stiffness: 1000")
    for share in np.linspace(0.0, 1.0, 41):
        start = hinge.go(0.05 * share, 0.03 * share)
    law, direction = hinge.law, np.array(onward)
    deformation = _pair.Motions(0.05, 0.03, *onward, speed=0.0, sizes=(0.0, 0.0))
    rows = _pair.tangent(law.p, law.old, deformation, law.bench.curves)
    K = sum(row[2] * np.outer(row[:2], row[:2]) for row in rows)
    change = (hinge.go(0.05 + 1e-7 * direction[0], 0.03 + 1e-7 * direction[1]) - start) / 1e-7
    # second derivatives, k over the elastic range, times the step
    np.testing.assert_allclose(change, K @ direction, atol=0.05)


def test_work_on_the_ellipse_is_stored_and_lost(tmp_path: Path) -> None:
    hinge = Rotated(tmp_path, "curve: up, second_curve: down, second_stiffness: 1000")
    rng, before = np.random.default_rng(3), np.zeros(2)
    work, x = 0.0, np.zeros(2)
    for _ in range(5):
        goal = rng.normal(scale=0.05, size=2)
        for _ in range(120):
            step = (goal - x) / 40.0
            moment = hinge.go(*(x + step))
            work += float(step @ (before + moment)) / 2.0
            x, before = x + step, moment
    # trapezoids on both sides: they differ where a step is cut into pieces
    assert work == pytest.approx(hinge.stored + hinge.lost, rel=2e-3)
