"""Inconsistencies of a model at its start: joints that do not close, contacts that penetrate."""

from collections.abc import Iterator

import numpy as np

from crashsolve.deck.keywords import answering
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.reading.items import Entry
from crashsolve.foundation.errors import DeckErrors
from crashsolve.system.engine import Engine

# a depth of this share of the model's size is touching
ONTO = 1e-9


def refuse_inconsistencies(deck: Deck, engine: Engine) -> None:
    """Raises DeckErrors, each at the card of the joint or contact."""
    errors = [
        deck.error(card, None, text, advice)
        for card, text, advice in _inconsistencies(deck, engine)
    ]
    if errors:
        raise DeckErrors(errors)


def _inconsistencies(deck: Deck, engine: Engine) -> Iterator[tuple[Entry, str, str]]:
    """Card, cause and advice."""
    entries = deck.entries
    joints = {name: card for k in answering("joints") for name, card in entries[k].items()}
    for name, text in engine.assembly_errors():
        yield joints[name], text, "correct the joint or the bodies"
    for name, text in overlaps(engine):
        yield entries["contacts"][name], text, "move the bodies apart"


def overlaps(engine: Engine) -> list[tuple[str, str]]:
    """Contacts with an initial penetration of unclear direction: (contact, cause).

    Sides are solid: a ball in a hollow one, or on its very middle, is not meant.
    """
    model = engine.model
    current, messages = int(engine.clock["current"]), {}
    for group in model.contact_groups:
        depth, thick = group.history["depth"][current], group.parameters["thick"]
        # a constraint has no depth: its surfaces begin apart, or touching
        limit = ONTO * model.size if group.is_unilateral else 0.5 * thick
        # of each card the deepest comes last, and remains
        for i in sorted(np.flatnonzero(depth > limit), key=depth.__getitem__):
            why = (
                "but nodes of a unilateral constraint must not begin inside"
                if group.is_unilateral
                else f"more than half of the {thick[i]:.3g} m from the middle of one side "
                "to the middle of the other"
            )
            card = model.contacts[group.parameters["card"][i]]
            bodies = [
                model.bodies[side[group.parameters[index][i]]["node"]]
                for side, index in ((group.elements_a, "a"), (group.elements_b, "b"))
            ]
            between = f" ('{bodies[0]}' in '{bodies[1]}')"
            messages[card] = f"begins {depth[i]:.3g} m deep, {why}{between}"
    for nodal in model.nodal_groups:
        depth = nodal.arrays["totals"]["depth"][0]
        if nodal.narrow is None and depth > ONTO * model.size:
            messages[nodal.card] = (
                f"begins {depth:.3g} m deep: nodes are nearer to faces than their common "
                "thickness; move them apart, or set `ring` if they are neighbours in the mesh"
            )
    return list(messages.items())
