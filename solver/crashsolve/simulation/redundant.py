"""Joints whose reactions the equations of motion do not determine.

Where rows of the constraint Jacobian depend on each other, D^T n = 0 for some n, so that any share
of n may be added to the multipliers without a change of the motion: the split of a force between
such joints is arbitrary, sums over them are not. Consequence to test: two hinges of a door share
its weight in any way; a ball and a point on a line, which have no redundant row, do not.
"""

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.model.jacobian import jacobian, null_space
from crashsolve.system.engine import Engine

# shares of the null space below this are round-off
NOTHING = 1e-9
# more rows than this are counted, not analysed: the singular values of so many take a second
MANY = 1000


def undetermined(engine: Engine) -> list[str]:
    """Names of joints with a reaction that is not determined, in the order of the deck."""
    model = engine.model
    if not model.joints or not model.saddle.redundant() or model.saddle.rows() > MANY:
        return []
    D = jacobian(model.joints, engine.state.rows, len(model.mass))[:, 1:]
    if not np.isfinite(D).all():
        # a run that has stopped with numbers beyond all bounds
        return []
    null = null_space(D.reshape(len(D), -1).T)
    names, first = [], 0
    for joint in model.joints:
        if np.abs(null[first : first + joint.rows]).max(initial=0.0) > NOTHING:
            names.append(joint.name)
        first += joint.rows
    return names


def arbitrary_reactions(joints: list[str], deck: Deck) -> list[str]:
    """The warning of channels under watch or expect that read one of these joints."""
    watched = [card.channel for card in deck.watch] + [card.channel for card in deck.expect]
    channels = {name: [f"jntforc.{name}."] for name in joints}
    for name, entry in deck.entries["sensors"].items():
        channels.get(getattr(entry.card, "joint", ""), []).append(f"secforc.{name}.")
    named = [
        name
        for name, prefixes in channels.items()
        if any(prefix in text for prefix in prefixes for text in watched)
    ]
    if not named:
        return []
    some, every = (", ".join(repr(name) for name in names) for names in (named, joints))
    return [
        f"reactions of {some} are not determined: joints {every} have redundant constraint rows, "
        "and the share of each in a force is arbitrary, whatever its stated error; only sums over "
        "these joints are results; release directions (a spherical joint and a point_on_line hold "
        "a door as two revolute joints do), or replace joints by bushings"
    ]
