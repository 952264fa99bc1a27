"""What cones and ranges of twist promise: they push back, store what they take, and are smooth."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import small_runs
from bench import Bench, Law, check_power, exponential, product, written
from scipy.spatial.transform import Rotation

from crashsolve.foundation.errors import DeckErrors
from crashsolve.foundation.orientation import matrix
from crashsolve.springs import cone_stop

JOINTS = """
curves:
  hard: {points: [[0, 0], [0.1, 2], [0.5, 60]], extrapolate: linear}
  low: {points: [[0, 0], [0.1, 0], [0.5, 8]], extrapolate: linear}
  pulls: {points: [[0, 0], [0.1, -1], [0.5, 60]], extrapolate: linear}
  pulls_both: {points: [[-0.5, -60], [-0.1, 1], [0, 0], [0.1, 1], [0.5, 60]]}
  falls: {points: [[0, 0], [0.1, 50], [0.2, 5]], extrapolate: linear}
joints:
  ball: {type: spherical, a: a, b: b, at: [0.4, 0.1, 0.2]}
"""
CONE = "type: cone_stop, joint: ball, axis: [1, 2, 0.5], toward: [0, 1, 3], pointer: [1, 1, 0]"
TWIST = (
    "type: twist_stop, joint: ball, axis: [1, 2, 0.5], toward: [0, 1, 3], pointer: [1, 1, 0.6],"
    " toward_b: [0.3, 0, 1], lower: 0.1, upper: 0.9"
)
SMOOTH = "stiffness: 30, transition: 0.15, damping: 2"
CURVED = "curve: hard, transition: 0.1, damping: 2"
RANGES = {
    "cone": f"{{{CONE}, half_angles: [0.6, 0.5, 0.9, 0.55], {SMOOTH}}}",
    "cone in b": f"{{{CONE}, half_angles: [0.8, 0.66, 1.1, 0.7], carrier: b, {SMOOTH}}}",
    "cone of a table": f"{{{CONE}, table: [[0.3, 0.6], [1.5, 0.9], [3, 0.5], [5, 0.7]], {CURVED}}}",
    "twist": f"{{{TWIST}, {SMOOTH}}}",
    "twist on a curve": f"{{{TWIST}, {CURVED}}}".replace("hard", "hard_both"),
}
BOTH = "  hard_both: {points: [[-0.5, -60], [-0.1, -2], [0, 0], [0.1, 2], [0.5, 60]]}\njoints:"
Make = Callable[[str], Law]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    text = JOINTS.replace("joints:", BOTH)
    return lambda law: Bench(tmp_path, f"{text}springs:\n  s: {law}\n").law("springs", "s")


@pytest.mark.parametrize("name", RANGES)
def test_a_range_turns_both_bodies_alike_and_writes_every_column(make: Make, name: str) -> None:
    law = make(RANGES[name])
    start, touched = law.bench.state(), 0
    for seed in range(12):
        law.bench.nodes[:] = start
        law.bench.shake(seed)
        before = law.old.tobytes()
        out = law.force()
        n = law.bench.nodes
        touched += out.stored > 0.0
        # sums of a few numbers below 1e2
        np.testing.assert_allclose(n.torque.sum(axis=0), 0.0, atol=1e-12)
        assert not n.force.any()
        assert written(law.new, law.module.HISTORY) and written(law.out, law.module.OUTPUT)
        assert law.old.tobytes() == before
    assert touched >= 3


@pytest.mark.parametrize("name", RANGES)
def test_its_power_is_stored_and_dissipated(make: Make, name: str) -> None:
    # central difference over 2e-6 s of moments with slopes below 1e2: 1e-9 of 10 W, and
    # round-off of 10 J, 1e-15 / 1e-6
    check_power(make(RANGES[name]), 40, rel=1e-6, abs=1e-7)


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    ["cone of a table", *(pytest.param(n, marks=pytest.mark.long) for n in ("cone", "twist"))],
)
def test_a_closed_excursion_does_no_work(make: Make, name: str) -> None:
    """The work along a path of small turns, by the mean torque of both ends of each."""
    law = make(RANGES[name].replace("damping: 2", "damping: 0"))
    rng = np.random.default_rng(2)
    first = law.bench.nodes[2].q.copy()
    corners = [np.zeros(3), *rng.uniform(-1.2, 1.2, (5, 3)), np.zeros(3)]
    works = []
    for steps in (200, 1600):
        law.bench.move(2, q=first)
        law.force()
        work, torque, most = 0.0, law.bench.nodes[2].torque.copy(), 0.0
        for start, end in zip(corners, corners[1:], strict=False):
            for k in range(steps):
                before = law.bench.nodes[2].q.copy()
                at = start + (k + 1) / steps * (end - start)
                law.bench.move(2, q=product(exponential(at), first))
                back = product(law.bench.nodes[2].q, before * [1, -1, -1, -1])
                rotation = Rotation.from_quat([*back[1:], back[0]]).as_rotvec()
                out = law.force()
                most = max(most, float(out.stored))
                work += 0.5 * float((torque + law.bench.nodes[2].torque) @ rotation)
                torque = law.bench.nodes[2].torque.copy()
        works.append(work)
        assert most > 0.5
    # the trapezoidal rule has order 2, and 1 in the steps in which the moment has a corner
    assert abs(works[1]) < 0.3 * abs(works[0]) + 1e-6 * most
    assert abs(works[1]) < 1e-5 * most


def test_the_moment_is_on_the_second_body_whichever_carries_the_cone(make: Make) -> None:
    """A circular cone about u of a with the pointer s of b is one about s of b of u."""
    same = "half_angles: [0.4, 0.4, 0.4, 0.4], stiffness: 30"
    across = "axis: [1, 1, 0], toward: [0, 1, 3], pointer: [1, 2, 0.5], carrier: b"
    moments = []
    for words in (CONE, f"type: cone_stop, joint: ball, {across}"):
        law = make(f"{{{words}, {same}}}")
        law.bench.rotation(2, np.array([0.9, -0.2, 0.4]))
        out = law.force()
        # of the torques on both bodies, that on b in its axes
        second = law.bench.nodes[2]
        np.testing.assert_allclose(second.A.reshape(3, 3) @ out.moment, second.torque, atol=1e-12)
        moments.append(np.array(out.moment))
    assert np.linalg.norm(moments[0]) > 1.0
    np.testing.assert_allclose(*moments, atol=1e-12)


def test_a_twist_is_counted_over_whole_revolutions(make: Make) -> None:
    """Past half a revolution it is the spin times the time, and the stop pushes back as before."""
    law = make(f"{{{TWIST}, stiffness: 30, transition: 0.15}}")
    law.force()
    law.accept()
    first, start = law.bench.nodes[2].q.copy(), float(law.out.angle)
    axis = law.bench.nodes[2].A.reshape(3, 3) @ law.p.axis_b
    for k in range(1, 101):
        law.bench.move(2, q=product(exponential(0.1 * k * axis), first))
        out = law.force()
        law.accept()
        # round-off of 10 rad
        assert out.angle == pytest.approx(start + 0.1 * k, abs=1e-12)
        # within the transition it is up to k d / 8 over its straight line
        assert out.torque == pytest.approx(30 * max(out.angle - 0.9 - 0.075, 0.0), abs=0.5625)


@pytest.mark.parametrize("seed", range(20))
def test_swing_and_twist_agree_with_an_independent_calculation(make: Make, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rotations = rng.uniform(-1.0, 1.0, (2, 3))
    for name in ("cone", "twist"):
        law = make(RANGES[name])
        for node in (1, 2):
            law.bench.rotation(node, rotations[node - 1])
        out = law.force()
        R = [Rotation.from_matrix(matrix(law.bench.nodes[k].q)) for k in (1, 2)]
        c = R[0].apply(unit([1, 2, 0.5]))
        side = R[0].apply(across([0, 1, 3], [1, 2, 0.5]))
        if name == "cone":
            s = R[1].apply(unit([1, 1, 0]))
            flat = s - (s @ c) * c
            phi = np.arctan2(np.cross(side, flat) @ c, side @ flat)
            # round-off of sines and cosines near 1
            assert out.swing == pytest.approx(np.arccos(s @ c), abs=1e-7)
            assert np.exp(1j * out.azimuth) == pytest.approx(np.exp(1j * phi), abs=1e-12)
            assert out.margin == pytest.approx(limit(phi, [0.6, 0.5, 0.9, 0.55]) - out.swing)
        else:
            s = R[1].apply(unit([1, 1, 0.6]))
            y = R[1].apply(across([0.3, 0, 1], [1, 1, 0.6]))
            axis = np.cross(s, c)
            angle = np.arctan2(np.linalg.norm(axis), s @ c)
            back = Rotation.from_rotvec(angle * unit(axis)).apply(y)
            tau = np.arctan2(np.cross(side, back) @ c, side @ back)
            assert out.angle == pytest.approx(tau, abs=1e-12)


UNLOADING = {
    "cone, permanent set": f"{{{CONE}, half_angles: [0.6, 0.5, 0.9, 0.55], curve: hard, "
    "unloading_stiffness: 400}",
    "cone, between curves": f"{{{CONE}, half_angles: [0.6, 0.5, 0.9, 0.55], curve: hard, "
    "unloading_stiffness: 400, unloading_curve: low}",
    "twist, permanent set": f"{{{TWIST}, curve: hard_both, unloading_stiffness: 400}}",
}


@pytest.mark.parametrize("name", UNLOADING)
def test_unloading_loses_what_it_absorbs_and_does_not_store(make: Make, name: str) -> None:
    """Strokes out of the range and back, deeper each time: absorbed = stored + lost."""
    law = make(UNLOADING[name])
    rng = np.random.default_rng(4)
    first = law.bench.nodes[2].q.copy()
    law.bench.move(1, v=np.zeros(3), w=np.zeros(3))
    law.force(0.0)
    law.accept()
    absorbed = lost = 0.0
    torque, before = np.zeros(3), first
    for reach in (0.6, 0.9, 1.2, 1.2):
        direction = reach * unit(rng.normal(size=3))
        for k in range(1, 301):
            at = np.sin(np.pi * k / 300) * direction
            rate = np.pi / 3 * np.cos(np.pi * k / 300) * direction
            law.bench.move(2, q=product(exponential(at), first), v=np.zeros(3), w=rate)
            back = product(law.bench.nodes[2].q, before * [1, -1, -1, -1])
            rotation = Rotation.from_quat([*back[1:], back[0]]).as_rotvec()
            out = law.force(0.01)
            now = law.bench.nodes[2].torque.copy()
            absorbed -= 0.5 * float((torque + now) @ rotation)
            lost += float(out.loss)
            torque, before = now, law.bench.nodes[2].q.copy()
            law.accept()
    assert lost > 1.0
    # mean torques over steps of 1e-2 rad with slopes up to 400 N m/rad, order 1 at the corners
    assert absorbed == pytest.approx(float(out.stored) + lost, abs=5e-4 * lost)


def unit(x: object) -> np.ndarray:
    v = np.asarray(x, float)
    return v / np.linalg.norm(v)


def across(x: object, axis: object) -> np.ndarray:
    """Unit vector of what x has across an axis."""
    return unit(np.asarray(x, float) - (np.asarray(x, float) @ unit(axis)) * unit(axis))


def limit(phi: float, half: list[float]) -> float:
    """Half angle of a cone of four, by the formula of the page."""
    i, x = divmod(phi % (2 * np.pi), 0.5 * np.pi)
    y = np.sin(0.25 * np.pi * x * 2 / np.pi * 2) ** 2
    f, g = half[int(i)] ** -2.0, half[(int(i) + 1) % 4] ** -2.0
    return float((f + (g - f) * y * y * (3 - 2 * y)) ** -0.5)


def test_the_limit_and_its_slopes_are_continuous_all_round() -> None:
    azimuth, half = np.array([0.0, 0.5, 2.0, 4.0]), np.array([0.3, 1.2, 0.2, 2.5])
    narrow = half**-2.0
    for phi, here in zip(azimuth, half, strict=True):
        below, above = (
            np.array(cone_stop.limit_between(azimuth, narrow, 4, phi + d)) for d in (-1e-5, 1e-5)
        )
        assert cone_stop.limit_between(azimuth, narrow, 4, phi)[0] == pytest.approx(here, rel=1e-14)
        # the slope grows as the third power of the distance, 1e-15, times some 1e3
        np.testing.assert_allclose(above, below, atol=1e-10)
    grid = np.linspace(-4, 8, 4001)
    values = np.array([cone_stop.limit_between(azimuth, narrow, 4, phi) for phi in grid])
    assert values[:, 0].min() >= 0.2 - 1e-12 and values[:, 0].max() <= 2.5 + 1e-12
    numeric = np.gradient(values[:, 0], grid)
    # second differences over 3e-3 rad where the fourth derivative is some 1e4
    np.testing.assert_allclose(values[1:-1, 1], numeric[1:-1], atol=0.05)


def test_forces_are_continuous_through_the_axis(make: Make) -> None:
    """The pointer passes the axis of the cone: no moment, a finite bound of the stiffness."""
    law = make(RANGES["cone"])
    c, s = law.p.axis_a, law.p.pointer
    A = law.bench.nodes[1].A.reshape(3, 3)
    rotation = Rotation.align_vectors([A @ c], [s])[0].as_quat()
    for tilt in (0.0, 1e-15, 1e-9, 1e-5):
        law.bench.move(2, q=np.array([rotation[3], *rotation[:3]]))
        law.bench.rotation(2, tilt * np.array([0.3, -0.4, 0.5]))
        out = law.force()
        assert out.torque == 0.0 and out.swing <= tilt + 2e-8
        assert np.isfinite(law.bench.nodes.stiffness).all()


@pytest.mark.parametrize("name", RANGES)
def test_its_tangent_is_the_slope_of_its_moment(make: Make, name: str) -> None:
    law = make(RANGES[name])
    kernel = law.module.range_tangent
    start, touched = law.bench.state(), 0
    for seed in range(20):
        law.bench.nodes[:] = start
        law.bench.shake(seed)
        law.force()
        law.accept()
        for past in (0.03, 0.12, 0.3):
            for rate in (-0.4, 0.7):
                values = [moment(law, past + d, rate) for d in (-1e-6, 1e-6)]
                rates = [moment(law, past, rate + d) for d in (-1e-6, 1e-6)]
                if min(*values, *rates) <= 0.0:
                    continue
                slope, damping = kernel(law.p, law.new, past, rate, law.bench.curves)
                # differences of moments of up to 40 N m, 1e-14 / 1e-6
                assert slope == pytest.approx((values[1] - values[0]) / 2e-6, rel=1e-6, abs=1e-6)
                assert damping == pytest.approx((rates[1] - rates[0]) / 2e-6, rel=1e-6, abs=1e-6)
                touched += 1
    assert touched > 20


def moment(law: Law, past: float, rate: float) -> float:
    args = (law.p, law.old, law.new, law.out, 1.0, past, rate, law.bench.curves)
    return float(law.module.range_moment(*args))


WRONG = {
    "begins at": f"{{{CONE}, half_angles: [0.1, 0.1, 0.1, 0.1], stiffness: 5}}",
    "needs one of half_angles and table": f"{{{CONE}, stiffness: 5}}",
    "needs one of stiffness and curve": f"{{{CONE}, half_angles: [1, 1, 1, 1]}}",
    "must not be along the axis": (
        "{type: cone_stop, joint: ball, axis: [1, 2, 0], toward: [2, 4, 0], pointer: [1, 1, 0],"
        " half_angles: [1, 1, 1, 1], stiffness: 5}"
    ),
    "axis: a direction needs a length": (
        "{type: cone_stop, joint: ball, axis: [0, 0, 0], toward: [2, 4, 0], pointer: [1, 1, 0],"
        " half_angles: [1, 1, 1, 1], stiffness: 5}"
    ),
    "half angles must be at most 2.9 rad": f"{{{CONE}, half_angles: [1, 1, 3, 1], stiffness: 5}}",
    "half_angles: must be greater than 0": f"{{{CONE}, half_angles: [1, 1, 0, 1], stiffness: 5}}",
    "table: azimuths must rise": f"{{{CONE}, table: [[1, 1], [0.5, 1]], stiffness: 5}}",
    "table: azimuths must be 0.0001 rad or more apart": (
        f"{{{CONE}, table: [[0, 1], [1.0e-5, 0.9], [1, 1]], stiffness: 5}}"
    ),
    "table: azimuths must be 0.0001 rad or more": (
        f"{{{CONE}, table: [[0, 1], [3, 0.9], [6.28315, 1]], stiffness: 5}}"
    ),
    "table: needs 2 to 24 azimuths, has 1": f"{{{CONE}, table: [[1, 1]], stiffness: 5}}",
    "table: needs 2 to 24 azimuths, has 0": f"{{{CONE}, table: [], stiffness: 5}}",
    "unloading needs a curve": (
        f"{{{CONE}, half_angles: [1, 1, 1, 1], stiffness: 5, unloading_stiffness: 9}}"
    ),
    "curve: must not change sign": f"{{{CONE}, half_angles: [1, 1, 1, 1], curve: pulls}}",
    "curve: must not change sign: past": f"{{{TWIST}, curve: pulls_both}}",
    "curve: falls beyond its end": f"{{{CONE}, half_angles: [1, 1, 1, 1], curve: falls}}",
    "curve: must begin below 0": f"{{{TWIST}, curve: hard}}",
    "lower: must be below upper": f"{{{TWIST}, stiffness: 5}}".replace("lower: 0.1", "lower: 0.9"),
    "begins with axis and pointer 3.142 rad apart": f"{{{TWIST}, stiffness: 5}}".replace(
        "pointer: [1, 1, 0.6]", "pointer: [-1.478093395732, -1.655231419102, -0.570481255355]"
    ),
    "begins at the twist": f"{{{TWIST}, stiffness: 5}}".replace(
        "lower: 0.1, upper: 0.9", "lower: -2.5, upper: -2.4"
    ),
}


@pytest.mark.parametrize("message", WRONG)
def test_a_range_that_cannot_be_meant_is_refused(make: Make, message: str) -> None:
    with pytest.raises(DeckErrors, match=message):
        make(WRONG[message])


@pytest.mark.long
def test_a_method_keeps_its_order_through_a_stop(tmp_path: Path) -> None:
    # out of the cone, into the stop, back through the pole: moment and stiffness have no jump
    scene = {
        "title": "rod in a cone",
        "bodies": {
            "rod": {
                "mass": 2,
                "inertia": [0.05, 0.05, 0.02],
                "position": [0, 0, 0.3],
                "velocity": [1.8, 0, 0],
                "angular_velocity": [0, 6, 1],
            }
        },
        "joints": {"ball": {"type": "spherical", "b": "rod", "at": [0, 0, 0]}},
        "springs": {
            "cone": {
                "type": "cone_stop",
                "joint": "ball",
                "axis": [0, 0, 1],
                "toward": [1, 0, 0],
                "pointer": [0, 0, 1],
                "half_angles": [0.2, 0.3, 0.25, 0.35],
                "stiffness": 400,
                "transition": 0.4,
            }
        },
    }
    ends = []
    for steps in (50, 100, 200, 400):
        result = small_runs.run(tmp_path, scene, 0.2, step=0.2 / steps, plain=True)
        ends.append([small_runs.last(result, f"rbdout.rod.position.{c}") for c in "xy"])
    changes = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    # rattle is of order 2; the last two of three pairs of steps are in its range
    assert small_runs.slopes(list(changes))[-1] == pytest.approx(2.0, abs=0.15)


# azimuths and half angles of a table: a jump within a milliradian, half angles a thousand times
# apart, and neither
TABLES = {
    "jump": ([0.5, 0.501, 3.0, 4.5], [0.3, 1.2, 1.1, 0.4]),
    "narrow": ([0.0, 1.6, 3.2, 4.8], [1e-3, 1.0, 0.8, 1.2]),
    "smooth": ([0.0, 1.6, 3.2, 4.8], [0.6, 0.5, 0.9, 0.55]),
}


@pytest.mark.parametrize("table", TABLES)
def test_the_step_knows_the_steepest_limit_of_a_cone(table: str) -> None:
    azimuth, half = TABLES[table]
    narrow = [angle**-2.0 for angle in half]
    steepest = 0.0
    ends = np.r_[azimuth, azimuth[0] + 2.0 * np.pi]
    for first, last in zip(ends[:-1], ends[1:], strict=True):
        near = np.geomspace(1e-8, 0.5, 1500)
        for x in (*near, *(1.0 - near)):
            limit, slope = cone_stop.limit_between(azimuth, narrow, 4, first + x * (last - first))
            sine = min(np.sin(min(limit, 3.0)), np.sin(min(limit + 0.5, 3.0)))
            steepest = max(steepest, (slope / sine) ** 2)
    # a few positions between two azimuths stand for all
    stretch = cone_stop._stretch(tuple(azimuth), tuple(narrow))
    assert stretch == pytest.approx(1.0 + steepest, rel=0.1)
