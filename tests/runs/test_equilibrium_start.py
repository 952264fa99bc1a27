"""Claims of `control: {start: equilibrium}`: loads in closed form, no transient, refusals."""

from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashpost.results.result import Result
from crashsolve import run
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.recording.engines import engine_of, prepared_engine
from crashsolve.scripting import RunFailed
from crashsolve.statics import start

CONTROL = "control: {start: equilibrium, end_time: 1, estimate: off}\n"
WEIGHT = "loads: {weight: {type: gravity, acceleration: [0, 0, -10]}}\n"


def solved(folder: Path, text: str, weight: str = WEIGHT) -> Result:
    path = folder / "deck.yaml"
    path.write_text("title: An equilibrium\n" + CONTROL + weight + text, "utf-8")
    return Result(run(path, folder / "results"))


def swing(result: Result, channel: str) -> tuple[float, float]:
    """Value at the start, and the largest difference from it."""
    values = result.series(channel).values
    return float(values[0]), float(np.abs(values - values[0]).max())


@pytest.mark.parametrize("height", first_quick([1.0, 0.999, 0.5, 1.2], 2))
def test_a_mass_hangs_on_its_spring(tmp_path: Path, height: float) -> None:
    text = f"""
bodies: {{ball: {{mass: 2, inertia: [1, 1, 1], position: [0, 0, {-height}]}}}}
springs: {{s: {{type: linear, b: ball, stiffness: 200, length: 0.9}}}}
"""
    result = solved(tmp_path, text)
    # 20 N stretch it by 0.1 m; left of accelerations is 1e-9 of gravity
    start, far = swing(result, "rbdout.ball.position.z")
    assert start == pytest.approx(-1.0, abs=1e-9)
    assert far < 1e-8


def test_matrices_of_other_configurations_leave_the_equilibrium_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They serve several iterations; the last correction is by those of the equilibrium itself."""
    deck = read_deck(Path(__file__).parents[2] / "decks/scenes/sports_car/rolling.yaml")
    tangent, counts, ends = start._EquilibriumSearch._tangent, [0, 0], []
    for k, contraction in enumerate((0.0, 0.2)):

        def counted(
            search: start._EquilibriumSearch, g: np.ndarray, step: float = start.STEP, k: int = k
        ) -> np.ndarray:
            counts[k] += 1
            return tangent(search, g, step)

        monkeypatch.setattr(start, "CONTRACTION", contraction)
        monkeypatch.setattr(start._EquilibriumSearch, "_tangent", counted)
        ends.append(engine_of(deck, *build(deck)).state.nodes["r"])
    # heights: nothing holds the car along its road and across; 1e-11 of the size counts as nothing
    assert np.abs(ends[1] - ends[0])[:, 2].max() < 3e-11
    assert counts[1] < 0.6 * counts[0]


@pytest.mark.parametrize(
    "name",
    first_quick(["scenes/sports_car/rolling", "extreme/belt_catch", "extreme/standing_car"], 1),
)
def test_runs_that_take_an_equilibrium_over_are_those_that_search_it(name: str) -> None:
    """Nodes, reactions and energies to the bit, at the start and later."""
    deck = read_deck(
        Path(__file__).parents[2] / f"decks/{name}.yaml", {"control.start": "equilibrium"}
    )
    first, prepared = prepared_engine(deck, *build(deck))
    second, _ = prepared_engine(deck, *build(deck), prepared)
    assert prepared.equilibrium is not None
    for engine in (first, second):
        engine.start()
    for moment in (0.0, 0.01, 0.05):
        for engine in (first, second):
            engine.reach(moment)
            engine.sample(moment)
        for data in ("nodes", "rows", "ledger"):
            assert getattr(first, data).tobytes() == getattr(second, data).tobytes()


def test_a_plank_divides_its_weight_by_lever_arms(tmp_path: Path) -> None:
    text = """
bodies:
  plank: {mass: 30, inertia: [1, 4, 4], mass_centre: [0.2, 0.05, 0], position: [0, 0, 0.1]}
springs:
  a: {type: linear, b: plank, at_a: [-1, 0.5, 9], at_b: [-1, 0.5, 0], stiffness: 4e3, length: 9}
  b: {type: linear, b: plank, at_a: [1, 0.5, 9], at_b: [1, 0.5, 0], stiffness: 3e3, length: 9}
  c: {type: linear, b: plank, at_a: [0, -0.7, 9], at_b: [0, -0.7, 0], stiffness: 5e3, length: 9}
"""
    result = solved(tmp_path, text)
    forces = {name: result.series(f"deforc.{name}.force").values for name in "abc"}
    loads = {name: float(force[0]) for name, force in forces.items()}
    # it hangs askew by some hundredths, which changes the arms by their square
    assert sum(loads.values()) == pytest.approx(300, rel=1e-3)
    assert -loads["a"] + loads["b"] == pytest.approx(300 * 0.2, rel=5e-3)
    assert 0.5 * (loads["a"] + loads["b"]) - 0.7 * loads["c"] == pytest.approx(15, rel=5e-3)
    for force in forces.values():
        assert np.abs(force - force[0]).max() < 1e-6 * 300


def test_belts_a_train_and_a_frame_begin_at_rest(tmp_path: Path) -> None:
    text = """
bodies:
  hung: {mass: 5, inertia: [1, 1, 1], position: [0, 0, -0.98]}
  first: {mass: 100, inertia: [1, 1, 1], position: [5, 0, 0]}
  second: {mass: 200, inertia: [1, 1, 1], position: [7, 0, 0]}
joints:
  rail_1: {type: prismatic, b: first, at: [5, 0, 0], axis: [1, 0, 0]}
  rail_2: {type: prismatic, b: second, at: [7, 0, 0], axis: [1, 0, 0]}
  foot: {type: weld, b: arm_start, at: [0, 5, 0]}
springs:
  hook: {type: linear, b: first, at_a: [4, 0, 0], stiffness: 1e4, length: 1}
  coupling: {type: linear, a: first, b: second, stiffness: 2e4, length: 2}
belts:
  strap:
    type: belt
    webbing: {stiffness: 4e4}
    route: [{anchor: {at: [0, 0, 0]}}, {anchor: {body: hung}}]
materials: {steel: {type: elastic, young: 2e11, poisson: 0.3, density: 7800}}
sections: {bar: {type: rectangle, width: 0.02, height: 0.02}}
parts:
  arm:
    {type: beam, mesh: {shape: line, from: [0, 5, 0], to: [0, 6, 0], elements: 8}, section: bar,
     material: steel, side: [1, 0, 0]}
"""
    leaning = WEIGHT.replace("[0, 0, -10]", "[1, 0, -10]")
    result = solved(tmp_path, text, leaning)
    x, z = (result.series(f"rbdout.hung.position.{axis}").values[0] for axis in "xz")
    # along the load, and longer by T/k
    assert -x / z == pytest.approx(0.1, abs=1e-9)
    assert np.hypot(x, z) == pytest.approx(0.98 * (1.0 + 5 * np.sqrt(101) / 4e4), abs=1e-9)
    # the load of both wagons on the hook, of one in the coupling
    start, far = swing(result, "rbdout.second.position.x")
    assert start == pytest.approx(7.0 + 300 / 1e4 + 200 / 2e4, abs=1e-9) and far < 1e-8
    # an eighth of the weight times L^3/(E I); lumped masses and shear change it by a share of 8^-2
    sag, far = swing(result, "rbdout.arm_end.position.z")
    weight, bending = 7800 * 0.02**2 * 10, 2e11 * 0.02**4 / 12
    assert sag == pytest.approx(-weight / (8 * bending), rel=0.02) and far < 1e-8


def cart(speed: float) -> str:
    """A cart on four free wheels, set 10 mm too high on them: it would fall and pitch first."""
    text = f"""
bodies:
  cart: {{mass: 200, inertia: [10, 60, 60], position: [0, 0, 0.5], velocity: [{speed}, 0, 0]}}
"""
    for k, (x, y) in enumerate(((1.2, 0.6), (1.2, -0.6), (-0.8, 0.6), (-0.8, -0.6))):
        text += f"""  wheel_{k}: {{mass: 10, inertia: [0.3, 0.5, 0.3], position: [{x}, {y}, 0.298],
    velocity: [{speed}, 0, 0], angular_velocity: [0, {speed / 0.297}, 0]}}
"""
    text += "joints:\n"
    for k in range(4):
        text += (
            f"  axle_{k}: {{type: revolute, a: cart, b: wheel_{k}, at: [0, 0, 0], "
            f"axis: [0, 1, 0], frame: wheel_{k}}}\n"
        )
    text += "surfaces: {road: {type: plane}}\ntyres:\n"
    for k in range(4):
        text += (
            f"  tyre_{k}: {{type: gim, wheel: wheel_{k}, road: [road], radius: 0.3, "
            "stiffness: 2e5, damping: 200, slip_stiffness: 5e4, cornering_stiffness: 4e4, "
            "friction_max: 0.9}\n"
        )
    return text


@pytest.mark.parametrize("speed", first_quick([0.0, 30.0]))
def test_a_cart_rolls_without_a_transient(tmp_path: Path, speed: float) -> None:
    result = solved(tmp_path, cart(speed))
    loads = [result.series(f"tyrout.tyre_{k}.normal").values for k in range(4)]
    whole = 2400.0
    front = loads[0] + loads[1]
    # 2 m apart, the mass centre 0.8 m before the rear ones; wheels bear themselves
    # but for the lever arms, which change by 1e-4 as it pitches on its tyres
    assert front == pytest.approx(np.full(len(front), 2000 * 0.4 + 200), rel=3e-4)
    assert sum(loads) == pytest.approx(np.full(len(front), whole), rel=1e-4)
    assert swing(result, "rbdout.cart.velocity.x")[1] < 1e-3 * max(speed, 1e-3)
    # it can roll, and nothing pushes it
    assert "nothing supports" not in (result.folder / "log.txt").read_text("utf-8")


@pytest.mark.long
def test_a_cart_with_free_wheels_stands_on_a_banked_road(tmp_path: Path) -> None:
    """Moments of leaning tyres push it along by less than its search leaves; the log says so."""
    banked = WEIGHT.replace("[0, 0, -10]", "[0, 1, -10]")
    result = solved(tmp_path, cart(0.0), banked)
    loads = [result.series(f"tyrout.tyre_{k}.normal").values for k in range(4)]
    masses = {"cart": 200.0} | {f"wheel_{k}": 10.0 for k in range(4)}
    z = {name: result.series(f"rbdout.{name}.position.z").values[0] for name in masses}
    moment = sum(mass * z[name] for name, mass in masses.items())
    # it leans by 4e-4, which moves its weight by as much of its height
    assert loads[0][0] + loads[2][0] - loads[1][0] - loads[3][0] == pytest.approx(
        moment / 0.6, rel=1e-2
    )
    for load in loads:
        # 1 % is allowed
        assert np.abs(load - load[0]).max() < 1e-3 * load[0]
    assert "nothing supports body" in (result.folder / "log.txt").read_text("utf-8")


def test_a_body_above_the_floor_is_set_down(tmp_path: Path) -> None:
    text = """
bodies: {ball: {mass: 2, inertia: [1, 1, 1], position: [0, 0, 0.3]}}
surfaces: {floor: {type: plane}, ball: {type: sphere, body: ball, radius: 0.1}}
contacts: {c: {a: [ball], b: [floor], normal: {type: hertz, stiffness: 1e6}}}
"""
    result = solved(tmp_path, text)
    start, far = swing(result, "rbdout.ball.position.z")
    assert start == pytest.approx(0.1 - (20 / 1e6) ** (2 / 3), abs=1e-9)
    assert far < 1e-8


def test_velocities_follow_the_joints(tmp_path: Path) -> None:
    # a pendulum that sags on its spring keeps turning about its hinge
    text = """
bodies: {rod: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0], velocity: [0, 0, -2],
  angular_velocity: [0, 2, 0]}}
joints: {hinge: {type: revolute, b: rod, at: [0, 0, 0], axis: [0, 1, 0]}}
springs: {s: {type: linear, b: rod, at_a: [1, 0, 1], stiffness: 100, length: 0.95}}
"""
    result = solved(tmp_path, text)
    x, v = (
        np.array([result.series(f"rbdout.rod.{what}.{axis}").values[0] for axis in "xyz"])
        for what in ("position", "velocity")
    )
    w = np.array([result.series(f"rbdout.rod.angular_velocity.{a}").values[0] for a in "xyz"])
    assert v == pytest.approx(np.cross(w, x), abs=1e-12)
    # the nearest of what the hinge allows, by the kinetic energy of the difference
    assert w[1] == pytest.approx(2.0, rel=1e-2)
    assert x[2] < -0.01


REFUSED = {
    "body 'ball': there is no equilibrium": "bodies: {ball: {mass: 2, inertia: [1, 1, 1]}}",
    "the equilibrium is unstable": """
bodies: {rod: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [0, 0, 1]}}
joints: {hinge: {type: revolute, b: rod, at: [0, 0, 0], axis: [0, 1, 0]}}
""",
    "body 'a': the stiffness of the forces on it is too large a number": """
bodies: {a: {mass: 1, inertia: [1, 1, 1]}, b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
springs: {s: {type: linear, a: a, b: b, stiffness: 1e308, length: 0.5}}
""",
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_has_no_equilibrium_is_refused(tmp_path: Path, message: str) -> None:
    with pytest.raises(RunFailed, match=message):
        solved(tmp_path, REFUSED[message])


def test_a_spring_that_begins_to_act_is_no_instability(tmp_path: Path) -> None:
    """Differences to one side give K = [[0, -k], [0, k]], of which the even part is indefinite."""
    text = """
bodies: {a: {mass: 1, inertia: [1, 1, 1]}, b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
curves: {rope: {points: [[0, 0], [1, 1e4]]}}
joints:
  slide_a: {type: prismatic, b: a, at: [0, 0, 0], axis: [1, 0, 0]}
  slide_b: {type: prismatic, b: b, at: [1, 0, 0], axis: [1, 0, 0]}
springs: {rope: {type: curve, a: a, b: b, curve: rope, acts: tension}}
"""
    _, far = swing(solved(tmp_path, text), "rbdout.b.position.x")
    assert far < 1e-8


def test_a_load_that_follows_the_motion_is_no_instability_below_flutter(tmp_path: Path) -> None:
    """Ziegler's column with masses 9 and 1 flutters from P l = 4 k on; from 2 k on K's even part
    is indefinite, though its determinant stays k^2.
    """
    text = """
bodies:
  low: {mass: 9, inertia: [1e-4, 1e-4, 1e-4], position: [0, 0, 1]}
  high: {mass: 1, inertia: [1e-4, 1e-4, 1e-4], position: [0, 0, 2]}
joints:
  foot: {type: revolute, b: low, at: [0, 0, 0], axis: [0, 1, 0]}
  knee: {type: revolute, a: low, b: high, at: [0, 0, 1], axis: [0, 1, 0]}
springs:
  at_foot: {type: torsional, a: ground, b: low, axis: [0, 1, 0], stiffness: 100}
  at_knee: {type: torsional, a: low, b: high, axis: [0, 1, 0], stiffness: 100}
loads: {thrust: {type: force, body: high, force: [0, 0, -300], axes: body}}
"""
    _, far = swing(solved(tmp_path, text, weight=""), "rbdout.high.position.x")
    assert far < 1e-8


def test_shells_are_not_moved(tmp_path: Path) -> None:
    text = """
materials: {m: {type: elastic, young: 2e11, poisson: 0.3, density: 7850}}
parts:
  plate:
    type: shell
    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [2, 2]}
    thickness: 0.01
    material: m
"""
    with pytest.raises(RunFailed, match="does not move the nodes of shells"):
        solved(tmp_path, text)
