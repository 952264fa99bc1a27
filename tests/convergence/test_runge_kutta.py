"""Claim: the Runge-Kutta methods have their declared orders, and the accuracy that is asked for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from test_integrator_order import IMPACT

from crashsolve.deck.read import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.integrators import dormand_prince_5, dormand_prince_8
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

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
TABLEAUX = pytest.mark.parametrize("method", METHODS)


def run(folder: Path, scene: dict[str, Any], end: float, **control: Any) -> Engine:
    """The scene at its end."""
    path = folder / "deck.yaml"
    given = {"end_time": end, "energy_limit": "off"} | control
    path.write_text(yaml.safe_dump({"control": given} | scene, sort_keys=False))
    engine = Engine(*build(read_deck(path)))
    engine.start()
    engine.advance(end)
    engine.sample()
    return engine


def posture(engine: Engine, body: str) -> np.ndarray:
    """Position and quaternion of a body."""
    node = engine.state.nodes[engine.model.bodies.index(body)]
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
        errors = [np.linalg.norm(posture(e, body) - posture(finest, body)) for e in engines]
        slopes = -np.diff(np.log(errors)) / np.diff(np.log(counts))
        order = METHODS[method].ORDER
        if body == "bob":
            # the projection takes away some of a pendulum's error: more than the order may show
            assert slopes[-1] > order - SLOPE, (body, errors)
        else:
            assert slopes[-1] == pytest.approx(order, abs=SLOPE), (body, errors)


@TABLEAUX
def test_a_smaller_tolerance_gives_a_smaller_error(method: str, tmp_path: Path) -> None:
    exact = run(tmp_path, SCENE, END, integrator="dormand_prince_8", tolerance=1e-13)
    for tolerance in (1e-4, 1e-7, 1e-10):
        engine = run(tmp_path, SCENE, END, integrator=method, tolerance=tolerance)
        worst = max(
            np.abs(posture(engine, body) - posture(exact, body)).max() for body in SCENE["bodies"]
        )
        # errors of steps add up over some tens of them, over a size of 10 m
        assert worst < 1000 * tolerance
        assert engine.clock.residual <= 1e-10
        assert engine.clock.rate_residual <= 1e-10
        # what the spring, the weight and the pin do is all accounted for
        assert abs(engine.ledger[-1]) < 1e4 * tolerance * engine.ledger[-2]


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
    with pytest.raises(DeckErrors, match="friction: 'bristle' counts in whole steps, integrator"):
        run(tmp_path, scene, 1.0, integrator="dormand_prince_5")


@TABLEAUX
def test_an_impact_converges_at_order_two_or_better(method: str, tmp_path: Path) -> None:
    # speed ratio that solves chi (1 + x) = ln[(1 + chi) / (1 - chi x)], chi = 9/16 (E1)
    exact = 0.7252408
    errors, steps = [], []
    for tolerance in (1e-4, 1e-6, 1e-8):
        engine = run(tmp_path, IMPACT, 2e-3, integrator=method, tolerance=tolerance)
        errors.append(abs(engine.state.nodes["v"][1, 2] - exact))
        steps.append(int(engine.clock["cycle"]))
        # its beginning and its end
        assert engine.clock["located"] == 2
    # steps fall differently on the impact each time, so single slopes scatter
    order = -np.log(errors[-1] / errors[0]) / np.log(steps[-1] / steps[0])
    assert order > 2 - SLOPE, (errors, steps)
