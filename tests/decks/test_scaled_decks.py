"""Claim: no law holds a number with a unit of its own: a model in other units moves alike.

Every length, mass and time of a deck is multiplied by a power of two, which rounds nothing, and
positions, velocities and energies must be those of the deck times theirs, to the bit.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from quick import first_quick

from crashsolve.channels.units import Unit, parse_unit
from crashsolve.deck import numbers
from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

DECKS = Path(__file__).resolve().parents[2] / "decks" / "verification"
# of different laws, without formulas, points of curves and defaults, which stay as they are
NAMES = ("contact/drops", "springs/elastoplastic", "springs/bushing", "joints/cone_stop")
NAMES += ("joints/rotation_friction", "friction/coulomb", "contact/faces", "contact/unilateral")
NAMES += ("parts/taut", "parts/bar_impact", "parts/shell_plate", "ties/node_to_face")
LENGTH, MASS, TIME = 2.0**-6, 2.0**-10, 2.0**-4


def factor(unit: str) -> float:
    length, mass, time, _ = map(float, parse_unit(unit).exponents)
    return LENGTH**length * MASS**mass * TIME**time


def scaled(value: str | float, wanted: str, bases: Mapping[str, Unit]) -> float:
    return numbers.number(value, wanted, bases) * factor(wanted)


def moved(deck: Path) -> dict[str, np.ndarray]:
    """Positions, velocities and energies at a tenth of the run."""
    read = read_deck(deck)
    engine = Engine(*build(read))
    engine.start()
    engine.advance(0.1 * read.control.end_time)
    engine.sample()
    nodes = engine.state.nodes
    return {"m": nodes["r"], "m/s": nodes["v"], "rad/s": nodes["w"], "J": engine.ledger.copy()}


@pytest.mark.parametrize("name", first_quick(NAMES, 2))
def test_a_model_in_other_units_moves_alike(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    moved_by_unit = moved(DECKS / f"{name}.yaml")
    monkeypatch.setattr("crashsolve.deck.card.number", scaled)
    other = moved(DECKS / f"{name}.yaml")
    assert np.any(moved_by_unit["J"] != 0.0)
    for unit, values in moved_by_unit.items():
        np.testing.assert_array_equal(other[unit], values * factor(unit), err_msg=unit)
