"""Claim: what is wholly held bears its load to the end; its energies are errors of the joints."""

from pathlib import Path

import pytest
from quick import first_quick

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import SolverError
from crashsolve.model.build import build
from crashsolve.model.ledger import IMBALANCE, LARGEST
from crashsolve.system.engine import Engine

END = 0.004
# at height zero a weight has no energy to compare with
DECK = """
control: {end_time: 0.004, step: 1e-6}
curves: {rising: {type: table, points: [[0, 0], [1, 50]]}}
bodies: {b: {mass: 2, inertia: [0.1, 0.1, 0.1], position: [0.1, 0.3, 0]}}
joints: {held: {type: weld, a: ground, b: b, at: [0, 0.1, 0]}}
loads: {load: LOAD}
"""
LOADS = {
    "weight": "{type: gravity}",
    "force": "{type: force, body: b, force: [0, 0, 1000], curve: rising}",
    "torque": "{type: torque, body: b, torque: [300, 20, 1000], curve: rising}",
}


def engine_of(folder: Path, load: str) -> Engine:
    deck = folder / "deck.yaml"
    deck.write_text(DECK.replace("LOAD", LOADS[load]), "utf-8")
    engine = Engine(*build(read_deck(deck)))
    engine.start()
    return engine


@pytest.mark.parametrize("load", first_quick(LOADS))
def test_a_load_on_what_cannot_move_does_no_work_that_is_judged(load: str, tmp_path: Path) -> None:
    engine = engine_of(tmp_path, load)
    engine.advance(END)
    engine.sample()
    engine.finish()
    assert engine.step_warnings() == []
    # less than energy_limit by far: the joint is closed to a tenth of its tolerance
    assert abs(engine.ledger[IMBALANCE]) < 0.01 * engine.ledger[LARGEST]


def test_an_error_beyond_what_the_joint_may_stand_open_still_stops(tmp_path: Path) -> None:
    engine = engine_of(tmp_path, "force")
    engine.advance(END)
    # what may be missing is 200 N over 1e-10 of a size below 1 m: 2e-8 J
    engine.state.clock["driver_work"] -= 1e-7
    with pytest.raises(SolverError, match="energy balance is off"):
        engine.sample()
        engine.finish()
