"""Claim: Runge-Kutta methods have their declared orders and keep the tolerance asked for."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from test_integrator_order import IMPACT, RETURNED

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.integrators import dormand_prince_5, dormand_prince_8
from crashsolve.model.build import build
from crashsolve.model.ledger import IMBALANCE, LARGEST
from crashsolve.system.engine import Engine
from crashsolve.system.implicit.stages import set_dense_weights

BENCHMARKS = Path(__file__).resolve().parents[2] / "decks" / "benchmark"

METHODS = {"dormand_prince_5": dormand_prince_5, "dormand_prince_8": dormand_prince_8}
# the slope of a method of order p over halved steps is p but for terms one order higher
SLOPE = 0.15
# a free body, a mass on a spring and a pendulum side by side: one scene to compile
SCENE: dict[str, Any] = {
    "bodies": {
        "free": {"mass": 1.0, "inertia": [1.0, 2.0, 2.5], "angular_velocity": [3.0, 0.5, 4.0]},
        "mass": {"mass": 1.0, "inertia": [1.0] * 3, "position": [10, 0, 1.5]},
        "bob": {
            "mass": 1.0,
            "inertia": [0.1] * 3,
            "position": [-1, 0, 0],
            "velocity": [0, 0, 3],
            "angular_velocity": [0, 3, 0],
        },
    },
    "joints": {"pin": {"type": "revolute", "b": "bob", "at": [0, 0, 0], "axis": [0, 1, 0]}},
    "springs": {
        "coil": {
            "type": "linear",
            "a": "ground",
            "b": "mass",
            "at_a": [10, 0, 0],
            "stiffness": 100.0,
            "length": 1.0,
        }
    },
    "loads": {"weight": {"type": "gravity", "acceleration": [0, 0, -9.80665]}},
}
END = 2.0
# steps at which the error of each body lies between the last digits and the first
STEPS = {
    "dormand_prince_5": {"free": (40, 80, 160), "mass": (320, 640), "bob": (40, 80, 160)},
    "dormand_prince_8": {"free": (32, 40), "mass": (40, 50), "bob": (64, 80)},
}
DENSE_ORDER = {"dormand_prince_5": 4, "dormand_prince_8": 7}
# errors of the steps and of the dense output within one add up: the limit is a little farther
DENSE_SLOPE = 0.2
TABLEAUX = pytest.mark.parametrize("method", METHODS)
LONG = pytest.mark.long
# every scene compiles with every method anew: one is enough by day
EITHER = pytest.mark.parametrize(
    "method", ["dormand_prince_5", pytest.param("dormand_prince_8", marks=LONG)]
)


def start(folder: Path, scene: Mapping[str, object], end: float, **control: Any) -> Engine:
    """The scene, ready to step."""
    path = folder / "deck.yaml"
    given = {"end_time": end, "energy_limit": "off"} | control
    path.write_text(yaml.safe_dump({"control": given, **scene}, sort_keys=False))
    engine = Engine(*build(read_deck(path)))
    engine.start()
    return engine


def run(
    folder: Path,
    scene: Mapping[str, object],
    end: float,
    at: float | None = None,
    **control: object,
) -> Engine:
    """The scene at its end, or sampled within the step that passes a time."""
    engine = start(folder, scene, end, **control)
    if at is None:
        engine.advance(end)
    else:
        engine.reach(at)
    engine.sample(at)
    return engine


def solved(deck: Path, **control: object) -> Engine:
    """A benchmark at its end, with another integrator and no step given."""
    given = read_deck(deck)
    words = {"step": "auto", "constraint_tolerance": 1e-13} | control
    given = replace(given, control=given.control.model_copy(update=words))
    engine = Engine(*build(given))
    engine.start()
    engine.advance(given.control.end_time)
    return engine


def configuration(engine: Engine, body: str) -> np.ndarray:
    """Position and quaternion of a body."""
    node = engine.state.nodes[engine.model.bodies.index(body)]
    return np.concatenate([node["r"], node["q"]])


def sampled(engine: Engine, body: str) -> np.ndarray:
    """The same at the last sample."""
    node = engine.nodes[engine.model.bodies.index(body)]
    return np.concatenate([node["r"], node["q"]])


@TABLEAUX
def test_a_tableau_is_consistent(method: str) -> None:
    m = METHODS[method]
    weights = m.A[m.STAGES - 1]
    # sum b_i c_i^k = 1 / (k + 1): the conditions of pure quadrature, to the order of the method
    for k in range(m.ORDER):
        assert np.dot(weights, m.C**k) == pytest.approx(1 / (k + 1), abs=1e-14)
    # an embedded method differs by a combination of the rates that is zero when they are equal
    assert m.E.sum(axis=1) == pytest.approx(np.zeros(m.ESTIMATES), abs=1e-14)


@TABLEAUX
def test_the_order_is_the_declared_one(method: str, tmp_path: Path) -> None:
    # tolerance sets how closely the projection closes the joints; the step is given
    close = {"tolerance": 1e-12}
    finest = run(tmp_path, SCENE, END, integrator="dormand_prince_8", step=END / 800, **close)
    z = finest.state.nodes["r"][2, 2]
    # z = l_0 - m g / k + a cos(omega t), an independent measure of the reference itself
    exact = 1 - 0.0980665 + (0.5 + 0.0980665) * np.cos(10 * END)
    assert z == pytest.approx(exact, abs=1e-13)
    for body, counts in STEPS[method].items():
        engines = [
            run(tmp_path, SCENE, END, integrator=method, step=END / n, **close) for n in counts
        ]
        errors = [
            np.linalg.norm(configuration(e, body) - configuration(finest, body)) for e in engines
        ]
        slopes = -np.diff(np.log(errors)) / np.diff(np.log(counts))
        order = METHODS[method].ORDER
        if body == "bob":
            # the projection takes away some of a pendulum's error: more than the order may show
            assert slopes[-1] > order - SLOPE, (body, errors)
        else:
            assert slopes[-1] == pytest.approx(order, abs=SLOPE), (body, errors)


@EITHER
def test_a_smaller_tolerance_gives_a_smaller_error(method: str, tmp_path: Path) -> None:
    exact = run(tmp_path, SCENE, END, integrator="dormand_prince_8", tolerance=1e-13)
    for tolerance in (1e-4, 1e-7, 1e-10):
        engine = run(tmp_path, SCENE, END, integrator=method, tolerance=tolerance)
        worst = max(
            np.abs(configuration(engine, body) - configuration(exact, body)).max()
            for body in SCENE["bodies"]
        )
        # errors of steps add up over some tens of them, over a size of 10 m
        assert worst < 1000 * tolerance
        assert engine.clock.residual <= 1e-10
        assert engine.clock.rate_residual <= 1e-10
        # what the spring, the weight and the pin do is all accounted for
        assert abs(engine.ledger[IMBALANCE]) < 1e4 * tolerance * engine.ledger[LARGEST]


@TABLEAUX
def test_the_dense_output_is_consistent(method: str) -> None:
    m = METHODS[method]
    rates = len(m.C)
    A = np.zeros((rates + 1, rates + 1))
    A[:-1, :-1] = m.A
    table = A.ravel()
    for part in (0.0, 0.3, 0.77, 1.0):
        set_dense_weights(table, m.DENSE.ravel(), m.TERMS, m.STAGES - 1, rates, part)
        weights = table[-rates - 1 : -1]
        for k in range(DENSE_ORDER[method]):
            # round-off of weights up to 20
            assert np.dot(weights, m.C**k) == pytest.approx(part ** (k + 1) / (k + 1), abs=1e-14)


@EITHER
def test_samples_within_steps_have_the_order_of_the_dense_output(
    method: str, tmp_path: Path
) -> None:
    close = {"tolerance": 1e-12}
    for body, counts in STEPS[method].items():
        errors = []
        for n in counts:
            # in the middle of the last step
            time = END * (1 - 0.5 / n)
            exact = run(tmp_path, SCENE, time, integrator="dormand_prince_8", tolerance=1e-13)
            engine = run(tmp_path, SCENE, END, integrator=method, step=END / n, at=time, **close)
            assert engine.clock["time"] > time
            errors.append(np.linalg.norm(sampled(engine, body) - sampled(exact, body)))
        slope = -np.diff(np.log(errors)) / np.diff(np.log(counts))
        # the error within one step is one order above that of the dense output
        assert slope[-1] > DENSE_ORDER[method] + 1 - DENSE_SLOPE, (body, errors)


@TABLEAUX
def test_samples_do_not_change_a_run(method: str, tmp_path: Path) -> None:
    control = {"integrator": method, "tolerance": 1e-6}
    once = run(tmp_path, SCENE, END, **control)
    often = start(tmp_path, SCENE, END, **control)
    for time in np.linspace(0.0, END, 101)[1:]:
        often.reach(time)
        often.sample(time)
        assert often.sampled["time"] == time
        # a sample closes its joints, and accounts for its energy, as well as a step does
        assert np.abs(often.rows["phi"]).max() < 1e-10 * often.model.size
        assert abs(often.ledger[IMBALANCE]) < 1e4 * 1e-6 * often.ledger[LARGEST]
    for name in ("r", "q", "v", "L"):
        assert (often.state.nodes[name] == once.state.nodes[name]).all()
    assert often.clock["cycle"] == once.clock["cycle"] < 101


@TABLEAUX
def test_what_rejected_steps_leave_in_stages_changes_nothing(method: str, tmp_path: Path) -> None:
    control = {"integrator": method, "tolerance": 1e-6}
    clean, engine = (start(tmp_path, SCENE, 0.1, **control) for _ in range(2))
    # stages of the dense output alone, of a step that went far into a stiff contact
    for name in ("rate_r", "rate_v", "rate_L"):
        engine.state.stages[name][METHODS[method].STAGES :] = np.nan
    for one in (clean, engine):
        one.advance(0.1)
    assert (engine.clock["impulse"] == clean.clock["impulse"]).all()
    assert engine.clock["driver_work"] == clean.clock["driver_work"]


@pytest.mark.long
def test_a_pendulum_of_hardly_any_inertia_keeps_the_order(tmp_path: Path) -> None:
    engine = solved(BENCHMARKS / "pendulum.yaml", integrator="dormand_prince_8", tolerance=1e-10)
    bob = engine.state.nodes[1]
    # elliptic functions for an inertia of 1e-9 kg m^2 (benchmarks/peers/reference.py)
    exact = [-0.27508748345412, -0.96141919912537]
    assert bob["r"][:2] == pytest.approx(exact, abs=1e-9)
    # steps of a seventh of a second on the way: round-off does not set them
    assert engine.clock["cycle"] < 300


@pytest.mark.long
def test_the_heavy_top_to_eight_digits(tmp_path: Path) -> None:
    engine = solved(BENCHMARKS / "heavy_top.yaml", integrator="dormand_prince_8", tolerance=1e-11)
    # published to eight digits, more of them in benchmarks/peers/reference.py
    axis = [-0.15041682274577, -0.72416559163704, -0.67302226956026]
    assert engine.state.nodes[1]["r"] == pytest.approx(axis, abs=1e-8)


@pytest.mark.long
def test_the_seven_bodies_to_nine_digits() -> None:
    deck = BENCHMARKS / "andrews_squeezer.yaml"
    engine = solved(deck, integrator="dormand_prince_8", tolerance=1e-12)
    start, nodes = read_deck(deck).parameters, engine.state.nodes
    # published to 16 digits (Test Set for IVP Solvers): angles beta, gamma, delta and epsilon
    for body, angle, name in (
        ("k1", 15.81077119629904, "be"),
        ("k5", 0.5244099658805304, "de"),
        ("k7", 1.048080741042263, "ep"),
    ):
        w, _, _, z = nodes[engine.model.bodies.index(body)]["q"]
        error = 2.0 * np.arctan2(z, w) - (angle - start[name])
        error = np.arctan2(np.sin(error), np.cos(error))
        # smaller accuracies settle at 7e-11 of beta, and at 1e-12 of the others
        assert abs(error) < 1e-9 * angle, body


def test_the_flat_configuration_is_passed() -> None:
    deck = BENCHMARKS / "four_bar_singular.yaml"
    engine = solved(deck, integrator="dormand_prince_8", tolerance=1e-10)
    # 3 theta'' = -3.5 g cos theta (benchmarks/peers/reference.py); twenty iterations of the fold
    tip = 2.0 * engine.state.nodes[engine.model.bodies.index("crank_1")]["r"][:2]
    assert tip == pytest.approx([0.32845811154026, 0.94451853817879], abs=1e-7)


@pytest.mark.long
@EITHER
def test_a_permanent_set_is_that_of_the_turning_point(method: str, tmp_path: Path) -> None:
    # a mass crushes a straight curve of slope k_1 and comes back on one of slope k: the set is what
    # it had at the turn, and of the energy 1/2 m v^2 the share k_1 / k returns
    scene = {
        "bodies": {
            "mass": {
                "mass": 2.0,
                "inertia": [1.0] * 3,
                "position": [1.5, 0, 0],
                "velocity": [-3.0, 0, 0],
            }
        },
        "curves": {"crush": {"points": [[-1.0, -400.0], [0.0, 0.0]], "extrapolate": "linear"}},
        "springs": {
            "box": {
                "type": "curve",
                "b": "mass",
                "length": 1.0,
                "curve": "crush",
                "unloading_stiffness": 900.0,
                "acts": "compression",
            }
        },
    }
    engine = run(tmp_path, scene, 1.0, integrator=method, tolerance=1e-11)
    # onset, turn and parting; a thousand times the tolerance, as above
    assert engine.clock["located"] == 3
    assert engine.state.nodes[1]["v"][0] == pytest.approx(3.0 * (400 / 900) ** 0.5, abs=1e-8)
    assert abs(engine.ledger[IMBALANCE]) < 1e-8 * engine.ledger[LARGEST]


@pytest.mark.parametrize(
    "method",
    [
        "dormand_prince_5",
        *(
            pytest.param(m, marks=LONG)
            for m in ("dormand_prince_8", "radau_iia_5", "generalized_alpha")
        ),
    ],
)
def test_friction_changes_its_regime_at_an_end_of_a_step(method: str, tmp_path: Path) -> None:
    # 1 kg slides at its depth of rest: from 3 m/s by mu g down to v_1, then v - v_0 decays
    mu, g, v_0, v_1, end = 0.3, 9.81, 0.1, 1.0, 1.2
    friction = {"type": "coulomb", "friction_coefficient": mu, "none_below": v_0, "full_above": v_1}
    normal = {"type": "kelvin_voigt", "stiffness": 1e4, "damping": 10.0}
    block = {"mass": 1.0, "inertia": [1.0] * 3, "position": [0, 0, -g / 1e4], "velocity": [3, 0, 0]}
    scene = {
        "bodies": {"block": block},
        "surfaces": {
            "tip": {"type": "point_set", "body": "block", "points": [[0, 0, 0]]},
            "floor": {"type": "plane"},
        },
        "contacts": {
            "rest": {"a": ["tip"], "b": ["floor"], "normal": normal, "friction": friction}
        },
        "loads": {"weight": {"type": "gravity", "acceleration": [0, 0, -g]}},
    }
    engine = run(tmp_path, scene, end, integrator=method, tolerance=1e-9)
    fading = end - (3.0 - v_1) / (mu * g)
    exact = v_0 + (v_1 - v_0) * np.exp(-mu * g * fading / (v_1 - v_0))
    assert engine.clock["located"] == 1
    # a thousand times the tolerance, as above
    assert engine.state.nodes[1]["v"][0] == pytest.approx(exact, abs=1e-6)


def test_a_law_that_counts_in_whole_steps_is_refused(tmp_path: Path) -> None:
    friction = {"type": "bristle", "stiffness": 1e4, "static": 0.3, "dynamic": 0.2}
    normal = {"type": "kelvin_voigt", "stiffness": 1e5, "damping": 10.0}
    scene = {
        "bodies": {"block": {"mass": 1.0, "inertia": [1.0] * 3, "position": [0, 0, 0.1]}},
        "surfaces": {
            "skin": {"type": "sphere", "body": "block", "radius": 0.1},
            "floor": {"type": "plane"},
        },
        "contacts": {
            "rest": {"a": ["skin"], "b": ["floor"], "normal": normal, "friction": friction}
        },
    }
    with pytest.raises(
        DeckErrors, match="friction: 'bristle' is computed in whole steps, integrator"
    ):
        run(tmp_path, scene, 1.0, integrator="dormand_prince_5")


def order_of_an_impact(method: str, folder: Path) -> float:
    """Order of the error in the number of steps, between tolerances of 1e-4 and 1e-8."""
    errors, steps = [], []
    for tolerance in (1e-4, 1e-6, 1e-8):
        engine = run(folder, IMPACT, 2e-3, integrator=method, tolerance=tolerance)
        errors.append(abs(engine.state.nodes["v"][1, 2] - RETURNED))
        steps.append(int(engine.clock["cycle"]))
        # its beginning and its end
        assert engine.clock["located"] == 2
    # steps fall differently on the impact each time, so single slopes scatter
    return float(-np.log(errors[-1] / errors[0]) / np.log(steps[-1] / steps[0]))


@EITHER
def test_an_impact_converges_at_order_two_or_better(method: str, tmp_path: Path) -> None:
    assert order_of_an_impact(method, tmp_path) > 2 - SLOPE
