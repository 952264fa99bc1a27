"""Claims of `phases`: equilibria in closed form, motion from them without a transient, refusals."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, gone_on
from quick import first_quick

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.scripting import RunFailed

WEIGHT = "loads: {weight: {type: gravity, acceleration: [0, 0, -10]}}\n"
# of the phase `settle` (s), then one of motion that is as long
HEAD = """
title: Phases
control: {{end_time: {end}, estimate: off{more}}}
phases: {{settle: {{type: equilibrium, end_time: {settle}}}, go: {{type: transient}}}}
"""


def solved(folder: Path, text: str, settle: float = 1.0, more: str = "") -> Result:
    path = folder / "deck.yaml"
    path.write_text(HEAD.format(end=2 * settle, settle=settle, more=more) + text, "utf-8")
    return Result(run(path, folder / "results"))


def motion(result: Result, channel: str, settle: float = 1.0) -> tuple[float, float]:
    """Value at the end of `settle`, and the largest difference from it later."""
    series = result.series(channel)
    values = series.values[series.time >= settle - 1e-9]
    return float(values[0]), float(np.abs(values - values[0]).max())


HANGS = """
bodies: {ball: {mass: 2, inertia: [1, 1, 1], position: [0, 0, -0.9]}}
springs: {s: {type: linear, b: ball, stiffness: 200, length: 0.9}}
"""


@pytest.mark.parametrize(
    "more",
    first_quick(
        [
            "",
            ", integrator: dormand_prince_5, step_max: 5e-3",
            ", integrator: generalized_alpha, step_max: 5e-3",
            ", integrator: radau_iia_5, step_max: 5e-3",
        ]
    ),
)
def test_a_mass_settles_on_its_spring_with_every_kind_of_method(tmp_path: Path, more: str) -> None:
    result = solved(tmp_path, WEIGHT + HANGS, more=more)
    # 20 N stretch it by 0.1 m; what is left of the force is below 1e-4 of them
    start, far = motion(result, "rbdout.ball.position.z")
    assert start == pytest.approx(-1.0, abs=1e-5)
    assert far < 2e-5
    # in the first steps, of little energy in all, methods that choose their step err by 1 % of it
    assert abs(result.series("glstat.model.balance").values[-1]) < 0.1
    # the weight does its work half by the hand that lets it down
    energies = {
        name: float(result.series(f"glstat.model.energy.{name}").values[-1])
        for name in ("driver_work", "potential", "spring_stored")
    }
    assert energies["spring_stored"] == pytest.approx(1.0, rel=1e-4)
    assert energies["driver_work"] == pytest.approx(energies["potential"] + 1.0, rel=1e-3)


def test_samples_added_while_loads_rise_have_the_loads_of_their_time(tmp_path: Path) -> None:
    text = """
output: {history: {interval: 0.1}}
bodies: {ball: {mass: 2, inertia: [1, 1, 1], position: [0, 0, 0.1001]}}
surfaces: {floor: {type: plane}, skin: {type: sphere, body: ball, radius: 0.1}}
contacts:
  c: {a: [skin], b: [floor], normal: {type: kelvin_voigt, stiffness: 1e6, restitution: 0.5}}
"""
    result = solved(tmp_path, WEIGHT + text)
    times = result.series("glstat.model.energy.kinetic").time
    assert ((times > 0.1) & (times < 0.4)).sum() > 10, "no interval was sampled step by step"
    # free fall is exact, and contact steps err by less
    assert np.abs(result.series("glstat.model.balance").values).max() < 0.02


@pytest.mark.long
def test_a_load_below_yield_that_would_yield_at_its_peak_leaves_no_set(tmp_path: Path) -> None:
    # let go at once, the mass would pull with twice its weight
    text = """
bodies: {ball: {mass: 2, inertia: [1, 1, 1], position: [0, 0, -0.9]}}
springs: {s: {type: elastoplastic, b: ball, stiffness: 2000, yield_force: 22, length: 0.9}}
"""
    result = solved(tmp_path, WEIGHT + text)
    assert np.abs(result.series("deforc.s.set").values).max() == 0.0
    assert motion(result, "deforc.s.force")[0] == pytest.approx(20.0, rel=1e-4)


CHAIN = """
bodies:
  a: {mass: 2, inertia: [1, 1, 1], position: [0, 0, -1]}
  b: {mass: 1, inertia: [1, 1, 1], position: [0, 0, -2]}
springs:
  s: {type: elastoplastic, b: a, stiffness: 2000, yield_force: 25, tangent: 500}
  t: {type: elastoplastic, a: a, b: b, stiffness: 700, yield_force: 9, tangent: 200}
"""


@pytest.mark.long
def test_the_set_of_a_chain_tends_to_that_of_loads_that_rise_slowly(tmp_path: Path) -> None:
    # (F - F_y) / k_t - (F - F_y) / k
    exact = 5 / 500 - 5 / 2000
    errors = []
    for settle in (2.0, 8.0):
        (tmp_path / str(settle)).mkdir()
        result = solved(tmp_path / str(settle), WEIGHT + CHAIN, settle)
        force, _ = motion(result, "deforc.s.force", settle)
        # the forces are those of equilibrium, whatever the path
        assert force == pytest.approx(30.0, rel=1e-4)
        errors.append(motion(result, "deforc.s.set", settle)[0] / exact - 1.0)
    # two vibrations pass their equilibria at different times: what overshoots falls with the rate
    assert 0.0 < errors[1] < 0.5 * errors[0] < 0.1


CART = """
bodies:
  cart: {mass: 200, inertia: [10, 60, 60], position: [0, 0, 0.5], velocity: [SPEED, 0, 0]}
"""


@pytest.mark.long
@pytest.mark.parametrize("speed", first_quick([0.0, 30.0]))
def test_a_car_body_begins_on_its_springs_without_a_transient(tmp_path: Path, speed: float) -> None:
    # set 10 mm too high on its wheels, on dampers and springs that are free at first
    text = CART.replace("SPEED", str(speed))
    corners = ((1.2, 0.6), (1.2, -0.6), (-0.8, 0.6), (-0.8, -0.6))
    for k, (x, y) in enumerate(corners):
        text += (
            f"  wheel_{k}: {{mass: 10, inertia: [0.3, 0.5, 0.3], position: [{x}, {y}, 0.3],\n"
            f"    velocity: [{speed}, 0, 0]}}\n"
        )
    text += "joints:\n"
    for k in range(4):
        text += (
            f"  strut_{k}: {{type: prismatic, a: cart, b: wheel_{k}, at: [0, 0, 0], "
            f"axis: [0, 0, 1], frame: wheel_{k}}}\n"
        )
    text += "springs:\n"
    for k, (x, y) in enumerate(corners):
        text += (
            f"  spring_{k}: {{type: linear, a: cart, b: wheel_{k}, at_a: [{x}, {y}, 0.3], "
            "stiffness: 2e4, damping: 600}\n"
        )
    text += "surfaces:\n  road: {type: plane}\n"
    for k in range(4):
        text += f"  tread_{k}: {{type: sphere, body: wheel_{k}, radius: 0.29}}\n"
    text += "contacts:\n"
    for k in range(4):
        text += (
            f"  tyre_{k}: {{a: [tread_{k}], b: [road], "
            "normal: {type: kelvin_voigt, stiffness: 2e5, damping: 500}}\n"
        )
    result = solved(tmp_path, WEIGHT + text, settle=2.0)
    loads = {k: motion(result, f"rcforc.tyre_{k}.force.z", 2.0) for k in range(4)}
    # 2 m apart, the mass centre 0.8 m before the rear ones; wheels bear themselves. It pitches by
    # 5 mm / 2 m, which changes lever arms by 3e-3 of their 0.3 m of height over 0.8 m
    assert loads[0][0] + loads[1][0] == pytest.approx(2000 * 0.4 + 200, rel=2e-3)
    assert sum(load for load, _ in loads.values()) == pytest.approx(2400, rel=1e-4)
    # of 500 N a wheel; it would be hundreds from the deck's positions
    assert max(far for _, far in loads.values()) < 0.2
    assert motion(result, "rbdout.cart.velocity.z", 2.0)[1] < 1e-4
    velocities = result.series("rbdout.cart.velocity.x")
    assert velocities.values[velocities.time < 2.0 - 1e-9] == pytest.approx(0.0, abs=1e-2)
    assert velocities.values[-1] == pytest.approx(speed, abs=1e-3)
    # the first touches, of wheels that hardly weigh anything yet, err by some % of what there is
    balance = result.series("glstat.model.balance")
    assert np.abs(balance.values[balance.time > 0.5]).max() < 0.5


BOLT = """
curves:
  pull: {points: [[0, 0], [1, 0], [1.2, 1], [2, 1]]}
bodies:
  plate: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0, 0.11]}
surfaces: {floor: {type: plane}, side: {type: sphere, body: plate, radius: 0.1}}
contacts:
  joint: {a: [side], b: [floor], normal: {type: kelvin_voigt, stiffness: 8e5, damping: 400}}
springs:
  bolt: {type: linear, a: ground, b: plate, at_a: [0, 0, -0.2], stiffness: 2e5, damping: 100,
         length: LENGTH}
loads: {pull: {type: force, body: plate, force: [0, 0, PULL], curve: pull}}
"""


@pytest.mark.parametrize("length, pull", first_quick([(0.29, 500.0), (0.28, 1500.0)]))
def test_a_bolt_is_preloaded_and_takes_its_share_of_a_load(
    tmp_path: Path, length: float, pull: float
) -> None:
    """The bolt diagram: k_b / (k_b + k_c) of a pull goes to the bolt while the joint is closed."""
    k_b, k_c, path = 2e5, 8e5, BOLT.replace("LENGTH", str(length)).replace("PULL", str(pull))
    # depth d: k_c d = k_b (0.3 - d - length)
    preload = k_b * k_c / (k_b + k_c) * (0.3 - length)
    result = solved(tmp_path, path)
    force, clamped = (result.series(name) for name in ("deforc.bolt.force", "rcforc.joint.normal"))
    at_end = np.searchsorted(force.time, 1.0 - 1e-9)
    assert force.values[at_end] == pytest.approx(preload, rel=1e-4)
    assert clamped.values[at_end] == pytest.approx(preload, rel=1e-4)
    # the pull rises within 0.2 s, over a vibration of 6 ms
    assert force.values[-1] == pytest.approx(preload + pull * k_b / (k_b + k_c), rel=1e-3)
    assert clamped.values[-1] == pytest.approx(preload - pull * k_c / (k_b + k_c), rel=1e-3)


BLOCK = """
bodies: {a: {mass: 2, inertia: [0.1, 0.1, 0.1], position: [0, 0, 0.101]}}
surfaces: {floor: {type: plane}, box: {type: box, body: a, size: [0.4, 0.4, 0.2]}}
contacts:
  c:
    a: [box]
    b: [floor]
    normal: {type: kelvin_voigt, stiffness: 1e5, damping: 100}
    friction: {type: bristle, static: MU, dynamic: MU, stiffness: 1e5}
loads: {weight: {type: gravity, acceleration: [2, 0, -10]}}
"""


def test_a_block_is_held_by_friction(tmp_path: Path) -> None:
    result = solved(tmp_path, BLOCK.replace("MU", "0.5"))
    assert motion(result, "rcforc.c.force.x")[0] == pytest.approx(-4.0, rel=1e-4)
    assert motion(result, "rbdout.a.position.x")[1] < 1e-7


@pytest.mark.long
def test_a_block_that_slides_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match=r"body 'a': phase 'settle' does not end in equilibrium: "):
        solved(tmp_path, BLOCK.replace("MU", "0.1"))


SHELL = """
materials: {m: {type: elastic, young: 2e9, poisson: 0.0, density: 8000}}
parts:
  strip:
    type: shell
    mesh: {type: grid, along: [0.5, 0, 0], across: [0, 0.1, 0], elements: [4, 1]}
    thickness: 0.01
    material: m
    supports: [{nodes: u0}]
    traces: [{name: tip, at: [0.5, 0, 0]}]
"""


@pytest.mark.long
def test_a_strip_of_shells_sags_and_rests(tmp_path: Path) -> None:
    result = solved(tmp_path, WEIGHT + SHELL, settle=0.3)
    sag, far = motion(result, "nodout.strip_tip.displacement.z", 0.3)
    # w l^4 / 8 E I = 37.5 mm; one point of integration bends 1 - 1/16 of it with four elements
    # along, 1.6 % less by the lumped weight, and rotations of 0.1 stiffen it by 1 %
    assert sag == pytest.approx(-0.0375, rel=0.08)
    assert far < 1e-3 * 0.0375


@pytest.mark.long
def test_shells_that_still_move_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match=r"part 'strip', node \d+: phase 'settle' does not end"):
        solved(tmp_path, WEIGHT + SHELL, settle=0.02)


def test_a_run_goes_on_within_each_phase_to_the_same_bits(tmp_path: Path) -> None:
    for settle in (1.9, 1.0):
        folder = tmp_path / str(settle)
        folder.mkdir()
        deck = folder / "deck.yaml"
        head = HEAD.format(end=2, settle=settle, more="")
        dumps = "output: {restart: {every: 0.4}, history: {interval: 0.01}}\n"
        deck.write_text(head + dumps + WEIGHT + CHAIN, "utf-8")
        done = crashsolve(deck, "-o", folder / "whole")
        assert done.returncode == 0, done.stderr
        gone_on(deck, folder / "whole", folder / "again")


REFUSED = {
    "phase 'go': end_time: the last phase ends with the run, at 2 s": "go: {end_time: 2}",
    "phase 'settle': another phase follows: give end_time, at which": "settle: {end_time: null}",
    "must lie between 0 s, where the phase begins, and 2 s": "settle: {end_time: 3}",
}


@pytest.mark.parametrize("message", REFUSED)
def test_times_that_do_not_follow_each_other_are_refused(tmp_path: Path, message: str) -> None:
    path = tmp_path / "deck.yaml"
    text = HEAD.format(end=2, settle=1, more="") + WEIGHT + HANGS
    phase, value = REFUSED[message].split(": ", 1)
    if phase == "go":
        text = text.replace("type: transient", "type: transient, " + value.strip("{}"))
    else:
        old = "type: equilibrium, end_time: 1"
        text = text.replace(old, "type: equilibrium, " + value.strip("{}"))
    path.write_text(text, "utf-8")
    done = crashsolve("check", path)
    assert done.returncode == 2
    assert message in done.stderr


def test_a_quasi_static_solution_has_no_phases(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match="a quasi-static solution has no phases"):
        solved(tmp_path, WEIGHT + HANGS, more=", solution: quasi_static")
