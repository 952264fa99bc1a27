"""Joints whose reactions the equations of motion do not determine.

Where rows of the constraint Jacobian depend on each other, D^T n = 0 for some n, so that any share
of n may be added to the multipliers without a change of the motion: the split of a force between
such joints is arbitrary, sums over them are not. Consequence to test: two hinges of a door share
its weight in any way; a ball and a point on a line, which have no redundant row, do not.
"""

from typing import Any

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.system.engine import Engine

# singular values below this share of the largest belong to redundant rows; shares of the null space
# below it are round-off
NOTHING = 1e-9
# more rows than this are counted, not looked at: the singular values of so many take a second
MANY = 1000


def undetermined(engine: Engine) -> list[str]:
    """Names of joints with a reaction that is not determined, in the order of the deck."""
    model = engine.model
    if not model.joints or not model.saddle.redundant() or model.saddle.rows() > MANY:
        return []
    null = _null_space_of_rows(_jacobian(engine))
    found, first = [], 0
    for joint in model.joints:
        if np.abs(null[first : first + joint.rows]).max(initial=0.0) > NOTHING:
            found.append(joint.name)
        first += joint.rows
    return found


def arbitrary_reactions(engine: Engine, deck: Deck) -> list[str]:
    """The warning of channels under watch or expect that name such a joint."""
    watched = [card.channel for card in deck.watch] + [card.channel for card in deck.expect]
    if not any("jntforc." in text for text in watched):
        return []
    joints = undetermined(engine)
    named = [name for name in joints if any(f"jntforc.{name}." in text for text in watched)]
    if not named:
        return []
    some, every = (", ".join(repr(name) for name in names) for names in (named, joints))
    return [
        f"reactions of {some} are not determined: redundant rows "
        f"join {every}, and the split of a force between them is "
        "arbitrary, whatever its stated error; only sums over them are results; release directions "
        "(a spherical joint and a point_on_line hold a door as two revolute joints do), or let a "
        "bushing bear them"
    ]


def _jacobian(engine: Engine) -> np.ndarray:
    """D (rows, 6 nodes) of all joints now, in the order of the joints."""
    model, rows = engine.model, engine.state.rows
    D = np.zeros((sum(joint.rows for joint in model.joints), 6 * len(model.mass)))
    first = 0
    for joint in model.joints:
        for k in range(joint.rows * joint.parts):
            part: Any = rows[joint.first_row + k]
            row = D[first + k % joint.rows]
            for name, half in (("node_a", slice(0, 6)), ("node_b", slice(6, 12))):
                node = int(part[name])
                if node:
                    row[6 * node : 6 * node + 6] += part["D"][half]
        first += joint.rows
    return D


def _null_space_of_rows(D: np.ndarray) -> np.ndarray:
    """Orthonormal columns (m, k) n with D^T n = 0."""
    left, values, _ = np.linalg.svd(D, full_matrices=True)
    rank = int((values > NOTHING * values.max(initial=0.0)).sum())
    null: np.ndarray = left[:, rank:]
    return null
