"""Claim: a channel has the same values however many samples are made into values at once."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.deck.reading.deck import read_deck
from crashsolve.model.build import build
from crashsolve.model.model import State
from crashsolve.recording.histories import Histories, Start

DECKS = Path(__file__).parents[2] / "decks"
# bodies, joints, springs, contacts; elements with gauges; nodes and cuts of shells
SCENES = [
    "scenes/train_test",
    "verification/materials/johnson_cook",
    "verification/parts/shell_cut",
]
SAMPLES = 7


def move(state: State, random: np.random.Generator, outputs: list[np.ndarray]) -> None:
    """Another state: numbers drawn at random."""
    tables = [state.nodes, state.rows, state.cards, state.card_history, state.points, *outputs]
    columns = [table[name] for table in tables for name in table.dtype.names or ()]
    for column in [*columns, state.ledger, state.blocks]:
        if column.dtype.kind == "f":
            column[...] = random.uniform(0.1, 1.0, column.shape)


@pytest.mark.parametrize("scene", SCENES)
def test_values_do_not_depend_on_the_samples_beside_them(scene: str) -> None:
    model, state = build(read_deck(DECKS / f"{scene}.yaml"))
    outputs = [group.output for group in model.groups]
    outputs += [model.elements.cuts] if model.elements else []
    together, alone = (Histories(Start(model, state)) for _ in range(2))
    random, samples = np.random.default_rng(1), []
    for _ in range(SAMPLES):
        move(state, random, outputs)
        together.take()
        alone.take()
        # later samples overwrite them
        samples.append({family: values.copy() for family, values in alone.values().items()})
    whole = together.values()
    assert len(whole) > 1
    for family, values in whole.items():
        single = np.concatenate([values[family] for values in samples])
        assert np.ptp(values, axis=0).any(), f"{family}: nothing has changed"
        np.testing.assert_array_equal(values, single, err_msg=family)
