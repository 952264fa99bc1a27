"""Claim: a sample needs no factors of its own: those of the step that ends there give the same."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.system.engine import Engine

ROOT = Path(__file__).parents[2]
DECKS = ("tests/runs/mechanism.yaml",) + tuple(
    f"decks/verification/joints/{word}.yaml" for word in ("gear", "point_driver", "rotation_driver")
)


def sampled(engine: Engine) -> tuple[bytes, ...]:
    """Nodes, rows and energies of a sample."""
    engine.sample()
    return tuple(table.tobytes() for table in (engine.nodes, engine.rows, engine.ledger))


@pytest.mark.parametrize("deck", DECKS)
def test_a_sample_with_and_without_factors_of_its_own(deck: str) -> None:
    engine = Engine(*build(read_deck(ROOT / deck, {"control.integrator": "rattle"})))
    engine.start()
    clock, saddle = engine.state.clock[0], engine.model.saddle
    assert clock["factored"] == 0.0
    for time in (0.01, 0.025, 0.2):
        engine.advance(time)
        assert clock["factored"] > 0.0
        given = sampled(engine)
        assert np.any(engine.rows["reaction"])
        columns, blocks = saddle.columns.copy(), saddle.blocks.copy()
        clock["factored"] = 0.0
        # the clock of a sample has it too, but is no result
        assert sampled(engine) == given
        assert np.array_equal(saddle.columns, columns)
        # nothing reads the last number
        assert np.array_equal(saddle.blocks[:-1], blocks[:-1])
