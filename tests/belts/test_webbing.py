"""Claims of belts: friction of rings, webbing kept, retractors, energy, in closed form."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.scripting import RunFailed

EA = 1e5
DECK = """
title: A ring between two anchors
control: {{end_time: {end}, step: {step}, estimate: off}}
output: {{history: {{interval: 1e-3}}}}
curves:
  linear: {{points: [[0, 0], [0.2, 2e4], [2, 2e5]]}}
  bent: {{points: [[0, 0], [0.02, 4e3], [1, 6e4]]}}
  spool: {{points: [[0, 3e3], [0.01, 4e3], [5, 4e3]]}}
  tighten: {{points: [[0, 2e3], [0.1, 1e3], [0.12, 0], [9, 0]]}}
  drive: {{type: formula, expression: "{drive}", from: 0, to: 1}}
bodies:
  car: {{mass: 1, inertia: [1, 1, 1]}}
joints:
  guide: {{type: prismatic, b: car, at: [0, 0, 0], axis: [{axis}]}}
  drive: {{type: translation_driver, joint: guide, curve: drive}}
belts:
  belt:
    {belt}
"""
# what goes to and fro, from rest
TO_AND_FRO = "0.1*(1 - cos(20*pi*x))"
AWAY = "0.05*(1 - cos(10*pi*x))"


def solved(folder: Path, belt: str, **words: Any) -> Result:
    given = {"end": 0.1, "step": 1e-4, "drive": AWAY, "axis": "1, 0, 0"} | words
    path = folder / "belt.yaml"
    path.write_text(DECK.format(belt=belt, **given), "utf-8")
    return Result(run(path, folder / "results"))


def series(result: Result, name: str) -> np.ndarray:
    return np.asarray(result.series(f"sbtout.belt.{name}").values)


def turned(mu: float, beta: float) -> str:
    """A belt that turns by beta in a ring at the ground, and is pulled by the car along x."""
    x, y = -np.cos(beta), np.sin(beta)
    back = f"{{at: [{-1 + 0.3 * x}, {0.3 * y}, 0]}}"
    # turned by beta from the direction of the car
    return f"route: [{{body: car}}, {{at: [-1, 0, 0], ring: {mu}}}, {back}]\n    force: linear"


@pytest.mark.parametrize("mu", [0.0, 0.1, 0.2, 0.6])
@pytest.mark.parametrize("beta", [0.3, 1.5707, 3.0])
def test_a_ring_slips_as_a_capstan(tmp_path: Path, mu: float, beta: float) -> None:
    result = solved(tmp_path, turned(mu, beta))
    T_1, T_2 = series(result, "force.1")[5:], series(result, "force.2")[5:]
    assert series(result, "angle.1")[0] == pytest.approx(beta, abs=1e-9)
    # as the car pulls away it slips all the time: closed to 1e-10 of the tension
    assert pytest.approx(np.full(len(T_1), np.exp(mu * beta)), rel=1e-9) == T_1 / T_2


def test_a_ring_holds_what_the_capstan_bears(tmp_path: Path) -> None:
    # a ring on the car, moved across: both spans grow alike, and nothing slips
    belt = "route: [{at: [0, -1, 0]}, {body: car, ring: 0.1}, {at: [0, 1, 0]}]\n    force: linear"
    result = solved(tmp_path, belt)
    assert np.abs(series(result, "slip.1")).max() == 0.0
    length = np.hypot(1.0, result.series("rbdout.car.position.x").values)
    assert series(result, "force.1") == pytest.approx(EA * (length - 1.0), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_ring_passed_to_and_fro_keeps_its_webbing(tmp_path: Path, mu: float) -> None:
    # along a belt that turns: the anchors stand off the line of the ring
    belt = f"route: [{{at: [-0.7, 0.5, 0]}}, {{body: car, ring: {mu}}}, {{at: [0.5, 0.5, 0]}}]"
    result = solved(tmp_path, f"{belt}\n    force: linear", drive=TO_AND_FRO)
    assert np.ptp(series(result, "webbing.1") + series(result, "webbing.2")) < 1e-14
    T_1, T_2 = series(result, "force.1"), series(result, "force.2")
    most = np.exp(mu * series(result, "angle.1"))
    assert (most * T_2 * (1.0 + 1e-9) >= T_1).all() and (most * T_1 * (1.0 + 1e-9) >= T_2).all()
    lost = result.series("glstat.model.energy.belt_dissipated").values
    # a cycle with friction loses, one without gives all back: second order in 1000 steps
    assert (lost[-1] > 1.0) if mu else abs(lost).max() < 1e-4
    assert np.abs(result.series("glstat.model.balance").values).max() < 1e-2


def test_states_do_not_depend_on_the_step(tmp_path: Path) -> None:
    belt = (
        "route: [{body: car}, {at: [-1, 0, 0], ring: 0.2}, {at: [-1, 0.4, 0], ring: 0.3}, "
        "{at: [-0.5, 0.8, 0]}]\n    force: linear"
    )
    found = []
    for step in (1e-3, 1e-4):
        folder = tmp_path / str(step)
        folder.mkdir()
        result = solved(folder, belt, step=step)
        found.append([series(result, f"force.{k}")[-1] for k in (1, 2, 3)])
    # all slip one way: the law of the rings alone says where the webbing is
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert found[0][0] / found[0][1] == pytest.approx(np.exp(0.2 * np.pi / 2), rel=1e-9)


def test_spans_between_rings_without_friction_are_one_belt(tmp_path: Path) -> None:
    found = []
    for rings in ("", "{at: [-0.8, 0, 0], ring: 0}, {at: [-0.4, 0, 0], ring: 0}, "):
        folder = tmp_path / str(len(rings))
        folder.mkdir()
        belt = f"route: [{{at: [-1, 0, 0]}}, {rings}{{body: car}}]\n    force: linear"
        found.append(series(solved(folder, belt), "force.1"))
    assert found[0] == pytest.approx(found[1], rel=1e-9, abs=1e-9)
    assert found[0][-1] == pytest.approx(EA * 0.1, rel=1e-9)


def test_unloading_leaves_a_set_and_loses_what_the_curves_enclose(tmp_path: Path) -> None:
    belt = "route: [{at: [-1, 0, 0]}, {body: car}]\n    force: bent\n    unloading_stiffness: 4e5"
    result = solved(tmp_path, belt, drive="0.04*(1 - cos(20*pi*x))")
    # stretched by 0.08 and let go: [0.02, 4e3] and on at 5.714e4
    most = 4e3 + 0.06 * 5.6e4 / 0.98
    lost = 0.5 * 0.02 * 4e3 + 0.5 * (4e3 + most) * 0.06 - 0.5 * most**2 / 4e5
    end = result.series("glstat.model.energy.belt_dissipated").values[-1]
    # trapezoids over 1000 steps, whose corner at 0.02 lies within one
    assert end == pytest.approx(lost, rel=1e-4)
    T = series(result, "force.1")
    assert T.max() == pytest.approx(most, rel=1e-6)
    assert T[-1] == 0.0


RETRACTED = "route: [{at: [-1, 0, 0]}, {body: car}]\n    force: linear\n    retractor: "


def test_a_free_retractor_pulls_with_its_spring(tmp_path: Path) -> None:
    result = solved(tmp_path, RETRACTED + "{pull: 5}")
    assert series(result, "force.1")[1:] == pytest.approx(np.full(100, 5.0), rel=1e-9)
    x = result.series("rbdout.car.position.x").values
    # length is strain and pay-out: 5 N strain the webbing by 5e-5
    assert series(result, "pay_out") == pytest.approx((1 + x) / (1 + 5 / EA) - 1.0, abs=1e-12)


@pytest.mark.parametrize("lock", ["lock_time: 0.03", "lock_speed: 0.5"])
def test_a_locked_retractor_pays_out_nothing(tmp_path: Path, lock: str) -> None:
    result = solved(tmp_path, RETRACTED + "{pull: 5, " + lock + "}")
    locked, out = series(result, "locked"), series(result, "pay_out")
    begun = np.flatnonzero(locked)
    assert 5 < len(begun) < 95
    assert np.ptp(out[begun]) < 1e-15
    assert series(result, "force.1")[-1] > 1e3


def test_a_load_limiter_pays_out_at_its_force(tmp_path: Path) -> None:
    result = solved(tmp_path, RETRACTED + "{pull: 5, lock_time: 0, limit: spool}")
    T, paid = series(result, "force.1"), series(result, "pay_out") - series(result, "pay_out")[0]
    beyond = paid > 0.01
    assert beyond.sum() > 20
    assert T[beyond] == pytest.approx(np.full(beyond.sum(), 4e3), rel=1e-9)
    rising = (paid > 1e-4) & ~beyond
    assert T[rising] == pytest.approx(3e3 + 1e5 * paid[rising], rel=1e-9)
    assert (np.diff(paid) >= 0.0).all()


def test_a_pretensioner_takes_up_the_slack_and_keeps_it(tmp_path: Path) -> None:
    belt = RETRACTED + "{pull: 1, lock_time: 0, pretensioner: tighten, fire_time: 0.05}"
    result = solved(tmp_path, belt + "\n    slack: 0.05", drive="0*x")
    T, out = series(result, "force.1"), series(result, "pay_out")
    assert T[30] == 0.0
    # 2e3 - 1e4 z at the pull-in z, of a belt of 1 m that was 0.05 m too long
    z = -out[-1]
    assert T[-1] == pytest.approx(2e3 - 1e4 * z, rel=1e-9)
    assert T[-1] == pytest.approx(EA * (1 / (1.05 - z) - 1), rel=1e-9)


@pytest.mark.parametrize("slack", [1e-3, 1.0])
@pytest.mark.parametrize("speed", [5.0, 500.0])
def test_a_fast_body_is_caught_and_nothing_is_gained(
    tmp_path: Path, slack: float, speed: float
) -> None:
    text = f"""
title: Caught
control: {{end_time: {3.0 * (slack + 0.2) / speed}, estimate: off}}
curves: {{linear: {{points: [[0, 0], [1, 1e6]], extrapolate: linear}}}}
bodies: {{ball: {{mass: 10, inertia: [1, 1, 1], position: [0, 0.5, 0], velocity: [0, {speed}, 0]}}}}
belts:
  belt:
    force: linear
    slack: {slack}
    route: [{{at: [-0.3, 0, 0]}}, {{body: ball, ring: 0.3}}, {{at: [0.3, 0, 0]}}]
"""
    path = tmp_path / "belt.yaml"
    path.write_text(text, "utf-8")
    result = Result(run(path, tmp_path / "results"))
    kinetic = result.series("glstat.model.energy.kinetic").values
    # it becomes taut within a step of a sixtieth of the belt's period, and slack again
    assert kinetic.max() <= kinetic[0] * (1.0 + 2e-3)
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.5


WRONG = {
    "there is no webbing beyond it": "route: [{at: [-1, 0, 0], ring: 0}, {body: car}]",
    "is fixed within the route": "route: [{at: [-1, 0, 0]}, {at: [0, 1, 0]}, {body: car}]",
    "a span has a length": "route: [{at: [0, 0, 0]}, {body: car}]",
    "all points are on one body": "route: [{at: [0, 1, 0]}, {at: [0, 2, 0]}]",
    "needs 2 to 8 points": "route: [{at: [0, 1, 0]}]",
    "must be at least 0 m": "slack: -0.1\n    route: [{at: [-1, 0, 0]}, {body: car}]",
    "is below the largest slope": (
        "unloading_stiffness: 100\n    route: [{at: [-1, 0, 0]}, {body: car}]"
    ),
    "pretensioner and fire_time belong together": (
        "retractor: {pull: 1, pretensioner: tighten}\n    route: [{at: [-1, 0, 0]}, {body: car}]"
    ),
    "before it acts": (
        "retractor: {pull: 1, limit: spool}\n    route: [{at: [-1, 0, 0]}, {body: car}]"
    ),
}


@pytest.mark.parametrize("message", WRONG)
def test_what_makes_no_belt_is_refused(tmp_path: Path, message: str) -> None:
    path = tmp_path / "belt.yaml"
    belt = f"force: linear\n    {WRONG[message]}"
    path.write_text(DECK.format(belt=belt, end=0.1, step=1e-4, drive=AWAY, axis="1, 0, 0"), "utf-8")
    with pytest.raises(DeckErrors) as caught:
        build(read_deck(path))
    assert message in str(caught.value)


def test_webbing_beyond_its_curve_stops_the_run(tmp_path: Path) -> None:
    belt = "route: [{at: [-0.01, 0, 0]}, {body: car}]\n    force: linear"
    with pytest.raises(RunFailed, match="linear"):
        solved(tmp_path, belt)
