"""Claim: every integrator has its declared order on bodies, springs and mechanisms (A1, A3, A6)."""

from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from test_runge_kutta import BENCHMARKS, END, SCENE, SLOPE, configuration, run

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

METHODS = ("rattle", "dormand_prince_5", "dormand_prince_8", "generalized_alpha", "radau_iia_5")
# end [s] and steps of each method at which its error lies between the first digits and the last
TOP, SQUEEZER = ("heavy_top.yaml", 0.2), ("andrews_squeezer.yaml", 0.006)
STEPS = {
    TOP: dict(
        zip(METHODS, [(1000, 2000), (800, 1120), (80, 112), (1000, 2000), (200, 400)], strict=True)
    ),
    SQUEEZER: dict(
        zip(METHODS, [(400, 800), (50, 100), (5, 7), (400, 800), (25, 50)], strict=True)
    ),
}
# what is judged: of a fast spin the quaternion loses its odd orders, which only change its length
JUDGED = {TOP: ("v", "w"), SQUEEZER: ("r", "q")}


def order_of(method: str) -> float:
    return float(import_module(f"crashsolve.integrators.{method}").ORDER)


def solved(case: tuple[str, float], method: str, count: int) -> np.ndarray:
    """The table of all bodies after a number of equal steps."""
    deck = read_deck(BENCHMARKS / case[0])
    # joints are closed, and stages solved, to the last digits
    words = {"end_time": case[1], "integrator": method, "step": case[1] / count}
    words |= {"tolerance": 1e-13, "constraint_tolerance": 1e-13, "energy_limit": "off"}
    deck = replace(deck, control=deck.control.model_copy(update=words))
    engine = Engine(*build(deck))
    engine.start()
    engine.advance(case[1])
    return engine.state.nodes[1:].copy()


@cache
def reference(case: tuple[str, float]) -> np.ndarray:
    """The same by steps four times finer than the finest of order 8: 4^-8 of its error."""
    return solved(case, "dormand_prince_8", 4 * STEPS[case]["dormand_prince_8"][1])


def distance(computed: np.ndarray, exact: np.ndarray, columns: tuple[str, ...]) -> float:
    return float(np.linalg.norm([np.linalg.norm(computed[c] - exact[c]) for c in columns]))


def slope(case: tuple[str, float], method: str) -> float:
    counts = STEPS[case][method]
    errors = [distance(solved(case, method, n), reference(case), JUDGED[case]) for n in counts]
    return float(np.log(errors[0] / errors[1]) / np.log(counts[1] / counts[0]))


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
def test_the_order_on_the_squeezer(method: str) -> None:
    assert slope(SQUEEZER, method) == pytest.approx(order_of(method), abs=SLOPE)


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
def test_the_order_on_the_heavy_top(method: str) -> None:
    # Euler parameters after 0.2 s are known to eight digits (benchmarks, A6)
    rotated = [-0.70827915, 0.43878109, 0.5457284, 0.08939975]
    quaternion = reference(TOP)["q"][0]
    assert quaternion * np.sign(quaternion[0] * rotated[0]) == pytest.approx(rotated, abs=1e-8)
    assert slope(TOP, method) == pytest.approx(order_of(method), abs=SLOPE)


def test_rattle_has_its_order_on_a_free_body_a_spring_and_a_pendulum(tmp_path: Path) -> None:
    finest = run(
        tmp_path, SCENE, END, integrator="dormand_prince_8", step=END / 800, tolerance=1e-12
    )
    counts = (640, 1280)
    runs = [run(tmp_path, SCENE, END, integrator="rattle", step=END / n) for n in counts]
    for body in SCENE["bodies"]:
        errors = [
            np.linalg.norm(configuration(e, body) - configuration(finest, body)) for e in runs
        ]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=SLOPE), (body, errors)
