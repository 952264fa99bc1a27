"""Friction of an explicit step: it may stop a slip, and never reverses it; the change of a slip
bounds the step, the steepness of friction does not.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from small_runs import last, run, slopes
from touching import Contact

from crashsolve.system.contact.pair import Slide

LAWS = {
    "coulomb": "friction_coefficient: 0.4, none_below: 0.01, full_above: 0.1",
    "stribeck": "static: 0.5, dynamic: 0.1, stribeck_speed: 0.01, smoothing_speed: 0.02",
}
N = 100.0
UP = (0, 0, 1)


@pytest.fixture(params=LAWS)
def contact(request: pytest.FixtureRequest, tmp_path: Path) -> Contact:
    return Contact(tmp_path, friction=f"{{type: {request.param}, {LAWS[request.param]}}}")


def friction_force(contact: Contact, v: float, compliance: float, is_ahead: bool = False) -> float:
    """Friction against a free slip of v; `is_ahead`: as between rigid bodies, whose slip of the
    middle of the step is known, or as at the nodes of shells.
    """
    contact.old.friction_force = 0.0
    middle = (v, 0.0, 0.0) if is_ahead else None
    result = contact.friction_force(N, (v, 0, 0), UP, compliance=compliance, middle=middle)
    return -float(result.force[0])


@pytest.mark.parametrize("is_ahead", [False, True])
@pytest.mark.parametrize("compliance", 10.0 ** np.arange(-8, 3))
def test_the_impulse_of_a_step_stops_a_slip_and_never_reverses_it(
    contact: Contact, compliance: float, is_ahead: bool
) -> None:
    for v in 10.0 ** np.arange(-6.0, 2.0, 0.5):
        friction = friction_force(contact, v, compliance, is_ahead)
        # twice what half a step takes; round-off, and the root of stribeck to 1e-13
        assert 0.0 <= 2.0 * compliance * friction <= v * (1 + 1e-12)


def test_it_is_the_law_at_the_slip_that_it_leaves(contact: Contact) -> None:
    # 1e-5 s/kg is a thirtieth of what would widen either law
    for v in (0.005, 0.02, 0.06, 0.5, 5.0):
        friction = friction_force(contact, v, 1e-5)
        assert friction_force(contact, v - 1e-5 * friction, 0.0) == pytest.approx(
            friction, rel=1e-9
        )


def test_friction_of_the_last_step_is_taken_out_of_the_slip(contact: Contact) -> None:
    """A slip that lasts is met by the friction of the law, however long the step."""
    friction = friction_force(contact, 0.06, 0.0)
    for compliance in (0.0, 1e-6, 1e-5):
        contact.old.friction_force = (-friction, 0.0, 0.0)
        again = -contact.friction_force(N, (0.06, 0, 0), UP, compliance=compliance).force[0]
        assert again == pytest.approx(friction, rel=1e-11)


@pytest.mark.parametrize("step", [5e-3, 1e-3, 1e-4])
def test_what_is_pushed_at_rest_creeps_as_the_law_says(step: float, tmp_path: Path) -> None:
    """With half of the friction, at half of the speed from which it is full, in any step."""
    scene = sliding(0.4)
    law = {"type": "coulomb", "friction_coefficient": 0.4, "none_below": 1e-4, "full_above": 1e-3}
    scene["contacts"]["hit"]["friction"] = law  # type: ignore[index]
    scene["bodies"]["ball"]["velocity"] = [0, 0, 0]  # type: ignore[index]
    push = [0.5 * 0.4 * 9.81, 0, -9.81]
    scene["loads"] = {"weight": {"type": "gravity", "acceleration": push}}
    result = run(tmp_path, scene, 1.0, step)
    # by then the torque of friction turns the ball, by 1e-6 m/s at its skin
    assert last(result, "rbdout.ball.velocity.x") == pytest.approx(5.5e-4, abs=1e-6)


def test_with_the_slip_of_a_step_it_loses_its_work_and_is_no_damper(contact: Contact) -> None:
    contact.old.friction_force = (-3.0, 1.0, 0.0)
    out = contact.friction_force(
        N, (0.06, 0, 0), UP, h=1e-3, compliance=1e-6, direction=(6e-5, 2e-5, 0.0)
    )
    mean = 0.5 * (np.array([-3.0, 1.0, 0.0]) + out.force)
    assert out.loss == pytest.approx(-mean @ (6e-5, 2e-5, 0.0), rel=1e-14)
    assert (out.power, out.damping) == (0.0, 0.0)


def test_friction_alone_sets_no_step(tmp_path: Path) -> None:
    """A ball on a floor, with and without friction that is full from a nanometre per second on."""
    cycles = []
    for mu in (0.0, 0.3):
        folder = tmp_path / f"{mu}"
        folder.mkdir()
        result = run(folder, sliding(mu), 0.05)
        cycles.append(result.status["cycle"])
        speed = last(result, "rbdout.ball.velocity.x")
        # slides with mu g; 5e-5: normal force and onset of the first step
        assert speed == pytest.approx(1.0 - mu * 9.81 * 0.05, abs=5e-5)
    assert cycles[1] == cycles[0]


NARROW = {
    "coulomb": {"friction_coefficient": 0.5, "none_below": 1e-3, "full_above": 0.01},
    "stribeck": {"static": 0.6, "dynamic": 0.5, "stribeck_speed": 0.1, "smoothing_speed": 0.005},
}


@pytest.mark.parametrize("word", NARROW)
def test_an_impact_in_which_a_slip_reverses_has_errors_of_second_order(
    word: str, tmp_path: Path
) -> None:
    """A rod strikes obliquely with its tip, which its inclination pushes on beyond rest."""
    law = {"type": word, **NARROW[word]}
    normal = {"type": "exact_restitution", "stiffness": 5e5, "restitution": 0.4}
    rod = {"mass": 2.0, "inertia": [0.02, 0.02, 0.002], "position": [0, 0, 0.3]}
    rod |= {"rotation": {"axis": [0, 1, 0], "angle": 0.5}, "angular_velocity": [0, 6, 0]}
    scene = {
        "title": "A rod strikes with its tip",
        "bodies": {"rod": rod | {"velocity": [0.5, 0.1, -4]}},
        "surfaces": {
            "floor": {"type": "plane"},
            "tip": {"type": "sphere", "body": "rod", "at": [0, 0, -0.15], "radius": 0.05},
        },
        "contacts": {"hit": {"a": ["tip"], "b": ["floor"], "normal": normal, "friction": law}},
    }
    speeds = []
    for safety in (0.1, 0.05, 0.025, 0.0125, 2e-3):
        folder = tmp_path / f"{safety}"
        folder.mkdir()
        control = {"end_time": 0.1, "safety": safety, "estimate": "off"}
        result = run(folder, scene | {"control": control}, 0.1)
        speeds.append([last(result, f"rbdout.rod.velocity.{axis}") for axis in "xyz"])
    errors = [float(np.abs(np.subtract(v, speeds[-1])).max()) for v in speeds[:-1]]
    # of 4 m/s
    assert errors[0] < 3e-4
    assert slopes(errors).mean() > 1.8


@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_a_slip_bounds_steps_by_its_relative_change(mu: float, tmp_path: Path) -> None:
    """From 10 m/s^2 a slip of 0.5 m/s changes by 20 of itself per second, one below v_1 by as much
    as at v_1; one that rests, or has no friction, has no bound.
    """
    words = f"{{type: coulomb, friction_coefficient: {mu}, none_below: 0.01, full_above: 0.1}}"
    contact = Contact(tmp_path, friction=words)

    def rate(v: float, change: float) -> float:
        middle = (v - 0.5e-3 * change, 0.0, 0.0)
        slide = Slide(N, (v, 0.0, 0.0), middle, None, UP, 1.0, 0.0)
        return float(contact.group.friction.slip_rate(contact.p, slide, 1e-3))

    acts = mu > 0.0
    assert rate(0.5, -10.0) == pytest.approx(10.0 / 0.49 * acts, rel=1e-9)
    assert rate(0.05, -10.0) == pytest.approx(10.0 / 0.09 * acts, rel=1e-9)
    assert rate(0.05, 0.0) == 0.0


def sliding(mu: float) -> dict[str, object]:
    law = {"type": "coulomb", "friction_coefficient": mu, "none_below": 0, "full_above": 1e-9}
    normal = {"type": "penalty", "stiffness": 1e4}
    ball = {"mass": 0.2, "inertia": [1e3, 1e3, 1e3], "velocity": [1, 0, 0]}
    return {
        "title": "A ball that does not turn",
        "bodies": {"ball": ball | {"position": [0, 0, 0.05 - 0.2 * 9.81 / 1e4]}},
        "surfaces": {
            "floor": {"type": "plane"},
            "ball": {"type": "sphere", "body": "ball", "radius": 0.05},
        },
        "contacts": {"hit": {"a": ["ball"], "b": ["floor"], "normal": normal, "friction": law}},
        "loads": {"weight": {"type": "gravity", "acceleration": [0, 0, -9.81]}},
    }


def test_what_a_contact_makes_is_reported(tmp_path: Path) -> None:
    """A ball bounces off a stiff floor in two and a half steps: the work is not what is stored."""
    scene = sliding(0.0)
    scene["bodies"]["ball"] |= {"position": [0, 0, 0.06], "velocity": [0, 0, -1]}  # type: ignore[index]
    log = SimpleNamespace(coarse="", fine="")
    for name, step in (("coarse", 1.3e-2 / 2.5 / 1.0), ("fine", 1e-4)):
        folder = tmp_path / name
        folder.mkdir()
        result = run(folder, scene, 0.03, step)
        setattr(log, name, (result.folder / "log.txt").read_text("utf-8"))
    assert "contact 'hit': its normal force has" in log.coarse
    assert "its normal force has" not in log.fine
