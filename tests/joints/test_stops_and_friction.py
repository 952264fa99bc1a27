"""What stops and friction of joints promise: balance, energy, limits, complete output."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Law, check_power, written

from crashsolve.foundation.errors import DeckErrors

JOINTS = """
curves:
  hard: {points: [[0, 0], [0.1, 2], [0.5, 60]], extrapolate: linear}
joints:
  hinge: {type: revolute, a: a, b: b, at: [0.4, 0.1, 0.2], axis: [1, 2, -1]}
  ball: {type: spherical, a: a, b: b, at: [0.4, 0.1, 0.2]}
  rail: {type: cylindrical, a: a, b: b, at: [0.4, 0.1, 0.2], axis: [1, 2, -1]}
"""
STOPS = {
    "rotation": "{type: rotation_stop, joint: hinge, "
    "lower: -0.4, upper: 0.4, stiffness: 9, damping: 2}",
    "turn on a curve": "{type: rotation_stop, joint: rail, lower: -0.1, curve: hard, damping: 2}",
    "slide": "{type: translation_stop, joint: rail, "
    "lower: -0.2, upper: 0.2, stiffness: 9, damping: 2}",
    "slide on a curve": "{type: translation_stop, joint: rail, upper: -0.05, curve: hard}",
}
LEVEL, PRESSED = 6.0, 0.25
FRICTION = {
    "rotation": f"{{type: rotation_friction, joint: hinge, "
    f"torque: {LEVEL}, stiffness: 400, damping: 3}}",
    "ball": f"{{type: rotation_friction, joint: ball, "
    f"torque: {LEVEL}, stiffness: 400, damping: 3}}",
    "slide": f"{{type: translation_friction, joint: rail, "
    f"force: {LEVEL}, stiffness: 400, damping: 3}}",
}
ALL = {f"stop, {direction}": text for direction, text in STOPS.items()} | {
    f"friction, {direction}": text for direction, text in FRICTION.items()
}
Make = Callable[[str], Law]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return lambda law: Bench(tmp_path, f"{JOINTS}springs:\n  s: {law}\n").law("springs", "s")


@pytest.mark.parametrize("case", ALL)
@pytest.mark.parametrize("seed", range(4))
def test_action_equals_reaction_also_in_moment(make: Make, case: str, seed: int) -> None:
    law = make(ALL[case])
    law.bench.shake(seed)
    law.force()
    n = law.bench.nodes
    moment = (n.torque + np.cross(n.r, n.force)).sum(axis=0)
    # sums of six products of numbers below 1e3
    np.testing.assert_allclose(n.force.sum(axis=0), 0.0, atol=1e-11)
    np.testing.assert_allclose(moment, 0.0, atol=1e-11)


@pytest.mark.parametrize("case", ALL)
def test_every_column_is_written_and_the_past_is_kept(make: Make, case: str) -> None:
    law = make(ALL[case])
    law.bench.shake(3)
    before = law.old.tobytes()
    for h in (1.0, 0.0):
        law.force(h)
        assert written(law.new, law.module.HISTORY)
        assert written(law.out, law.module.OUTPUT)
        assert np.isfinite([law.out.stored, law.out.power, law.out.loss]).all()
        assert h > 0.0 or law.out.loss == 0.0
    assert law.old.tobytes() == before


@pytest.mark.parametrize("case", STOPS)
def test_a_stop_only_pushes_and_its_power_is_stored_and_dissipated(make: Make, case: str) -> None:
    # central difference: relative error 1e-12 times speeds and curvatures of a few units, and
    # round-off of up to 10 J, 1e-15 / 1e-6
    check_power(make(STOPS[case]), 30, rel=1e-7, abs=1e-8)


@pytest.mark.parametrize("case", STOPS)
def test_the_side_of_a_stop(make: Make, case: str) -> None:
    law = make(STOPS[case])
    name = "travel" if "slide" in case else "angle"
    force = "force" if "slide" in case else "torque"
    start = law.bench.state()
    for seed in range(30):
        law.bench.nodes[:] = start
        law.bench.shake(seed)
        out = law.force()
        inside = law.p.lower <= out[name] <= law.p.upper
        beyond = 1.0 if out[name] > law.p.upper else -1.0
        assert out[force] == 0.0 if inside else beyond * out[force] >= 0.0


@pytest.mark.parametrize("case", FRICTION)
def test_friction_stays_below_its_limit_and_its_work_is_stored_or_lost(
    make: Make, case: str
) -> None:
    law = make(FRICTION[case])
    rng = np.random.default_rng(5)
    law.force(0.0)
    law.accept()
    absorbed = lost = 0.0
    force, saw_sliding, saw_holding = np.zeros(3), False, False
    for k in range(400):
        # strokes of twenty steps; the joint's other freedoms stay where they are
        if k % 20 == 0:
            rate = rng.uniform(-1.0, 1.0) * (0.1 if k % 60 == 0 else 3.0)
        h = 0.01
        rotation, travel = step(law, case, h * rate)
        out = law.force(h)
        slid = float(out.accumulated_slip - law.old.accumulated_slip)
        saw_sliding, saw_holding = saw_sliding or slid > 0.0, saw_holding or slid == 0.0
        now = wrench(law, case)
        assert np.linalg.norm(now) <= LEVEL * (1.0 + 1e-12)
        absorbed -= 0.5 * float((force + now) @ (rotation if case != "slide" else travel))
        lost += float(out.loss)
        force = now
        law.accept()
    # round-off of 400 sums; the axes of the torque turn with a, which stands still
    assert absorbed == pytest.approx(float(law.out.stored) + lost, abs=1e-9)
    assert saw_sliding and saw_holding and lost > 10.0


def axis_of(law: Law) -> np.ndarray:
    """The joint's axis, or an oblique one for a ball."""
    a = law.p.axis_a if np.any(law.p.axis_a) else np.array([2.0, -1.0, 2.0]) / 3.0
    axis: np.ndarray = law.bench.nodes[1].A.reshape(3, 3) @ a
    return axis


def step(law: Law, case: str, amount: float) -> tuple[np.ndarray, np.ndarray]:
    """Turn or move b against a along the joint; the vectors of both."""
    u, b = axis_of(law), law.bench.nodes[2]
    law.bench.move(1, v=np.zeros(3), w=np.zeros(3))
    if case == "slide":
        law.bench.move(2, r=b.r + amount * u, v=amount / 0.01 * u, w=np.zeros(3))
        return np.zeros(3), amount * u
    law.bench.rotation(2, amount * u)
    law.bench.move(2, v=np.zeros(3), w=amount / 0.01 * u)
    return amount * u, np.zeros(3)


def wrench(law: Law, case: str) -> np.ndarray:
    """Force or torque on b."""
    b = law.bench.nodes[2]
    return np.array(b.force if case == "slide" else b.torque)


@pytest.mark.parametrize("case", FRICTION)
def test_what_is_held_springs_back_to_where_it_was(make: Make, case: str) -> None:
    law = make(FRICTION[case])
    law.force(0.0)
    law.accept()
    # a stretch of 0.01 needs 4 of the 6 that it holds, for any number of times
    for k in range(1000):
        step(law, case, 0.01 if k % 2 == 0 else -0.01)
        law.bench.move(2, v=np.zeros(3), w=np.zeros(3))
        out = law.force(0.01)
        law.accept()
        assert out.accumulated_slip == 0.0
    # round-off of a thousand turns
    np.testing.assert_allclose(wrench(law, case), 0.0, atol=1e-10)


def press(
    law: Law, opening: Sequence[float], closing: Sequence[float], before: float, h: float = 0.1
) -> float:
    """Limit at the end of a step h, after one of 0.3 s at the start of which `before` pressed."""
    rows = slice(law.p.first_row, law.p.first_row + len(opening))
    law.bench.rows.multiplier[rows] = opening
    law.bench.rows.reaction[rows] = closing
    law.old.pressing, law.old.step, law.old.limit = before, 0.3, 7.0
    return float(law.force(h).limit)


def test_the_limit_follows_the_reaction(make: Make) -> None:
    law = make(
        "{type: rotation_friction, joint: ball, "
        "torque: 2, friction_coefficient: 0.5, radius: 0.5, stiffness: 9}"
    )
    # three quarters of the opening and a quarter of the closing kick, (3, 4, 12), and a third of
    # the change over three times the step
    limit = press(law, (2.0, 4.0, 12.0), (6.0, 4.0, 12.0), before=12.7)
    assert limit == pytest.approx(2.0 + PRESSED * 13.1, rel=1e-15)
    law = make(
        "{type: translation_friction, joint: rail, friction_coefficient: 0.25, stiffness: 9}"
    )
    across = (3.0, 4.0, 50.0, 60.0)
    assert press(law, across, across, before=5.3) == pytest.approx(PRESSED * 4.9, rel=1e-15)
    # a sample repeats the last step
    assert press(law, across, across, before=5.3, h=0.0) == 7.0


def test_a_reaction_that_jumps_has_no_trend(make: Make) -> None:
    law = make(
        "{type: translation_friction, joint: rail, friction_coefficient: 0.25, stiffness: 9}"
    )
    for before, taken in ((0.0, 1.1), (50.0, 0.9)):
        limit = press(law, (3.0, 4.0), (3.0, 4.0), before)
        assert limit == pytest.approx(PRESSED * 5.0 * taken, rel=1e-15)


WRONG = {
    "needs lower, upper or both": "{type: rotation_stop, joint: hinge, stiffness: 5}",
    "lower: must not exceed upper": (
        "{type: rotation_stop, joint: hinge, stiffness: 5, lower: 1, upper: 0}"
    ),
    "needs one of stiffness and curve": "{type: translation_stop, joint: rail, lower: 0}",
    "curve: must begin at 0, where the joint meets the stop": (
        "{type: translation_stop, joint: rail, lower: 0, curve: late}"
    ),
    "joint: 'hinge' is of type revolute and has no travel; name one of type": (
        "{type: translation_stop, joint: hinge, lower: 0, stiffness: 5}"
    ),
    "joint: 'rail' is of type prismatic and has no angle or ball; name one of type": (
        "{type: rotation_friction, joint: rail, torque: 1, stiffness: 5}"
    ),
    "needs torque, friction_coefficient or both": (
        "{type: rotation_friction, joint: hinge, stiffness: 5}"
    ),
    "friction_coefficient and radius belong together": (
        "{type: rotation_friction, joint: hinge, stiffness: 5, friction_coefficient: 0.1}"
    ),
    "needs force, friction_coefficient or both": (
        "{type: translation_friction, joint: rail, stiffness: 5}"
    ),
}


HINGE = """
curves: {yield: {points: [[0, 0], [0.1, 40], [3, 50]], extrapolate: linear}}
hinges:
  fold: {type: bending, a: a, b: b, at: [0.4, 0.1, 0.2], axis: [1, 2, -1], curve: yield%s}
joints:
  table: {type: planar, a: a, b: b, at: [0.4, 0.1, 0.2], axis: [1, 2, -1]}
  hinge: {type: revolute, a: a, b: b, at: [0.4, 0.1, 0.2], axis: [1, 2, -1]}
springs: {s: {type: rotation_stop, joint: %s, lower: -0.1, upper: 0.1, stiffness: 9, damping: 2}}
"""


@pytest.mark.parametrize("joint", ["fold", "table"])
def test_a_stop_acts_on_whatever_has_an_angle(tmp_path: Path, joint: str) -> None:
    """A plastic hinge and a planar joint bear the stop that a hinge of the same axis bears."""
    torques = []
    for name in (joint, "hinge"):
        law = Bench(tmp_path, HINGE % ("", name)).law("springs", "s")
        law.bench.shake(2)
        torques.append(float(law.force().torque))
    assert torques[0] == torques[1] != 0.0


def test_no_stop_outlives_the_hinge_that_it_is_on(tmp_path: Path) -> None:
    fails = ", failure_angle: 0.5"
    with pytest.raises(DeckErrors, match="'fold' separates when it fails, and this would still"):
        Bench(tmp_path, HINGE % (fails, "fold"))
    Bench(tmp_path, HINGE % (fails + ", after_failure: loose", "fold"))


@pytest.mark.parametrize("message", WRONG)
def test_what_cannot_be_meant_is_refused(tmp_path: Path, message: str) -> None:
    joints = JOINTS.replace("type: cylindrical", "type: prismatic").replace(
        "joints:", "  late: {points: [[0.1, 0], [1, 5]]}\njoints:"
    )
    with pytest.raises(DeckErrors) as caught:
        Bench(tmp_path, f"{joints}springs:\n  s: {WRONG[message]}\n")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("stop", "size"),
    [
        ("rotation_stop, joint: hinge, lower: 0.2", "0.2 rad past the range from 0.2 to inf rad"),
        ("translation_stop, joint: rail, upper: -0.05", "0.05 m past the range from -inf to -0.05"),
    ],
)
def test_a_stop_that_begins_past_its_range_is_a_warning(make: Make, stop: str, size: str) -> None:
    law = make(f"{{type: {stop}, stiffness: 9}}")
    (warning,) = (w for w in law.bench.model.warnings if "past the range" in w)
    assert f"begins {size}" in warning
