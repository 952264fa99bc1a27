"""Inconsistencies of a model at its start: joints that do not close, contacts that penetrate."""

from collections.abc import Iterator

import numpy as np

from crashsolve.deck.keywords import answering
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.reading.items import Entry
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.contact.groups import ContactGroup
from crashsolve.system.diagnosis import bodies_of_pair
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
    current, messages, worst = int(engine.clock["current"]), {}, {}
    for group in model.contact_groups:
        depth, thick = group.history["depth"][current], group.parameters["thick"]
        # a constraint has no depth: its surfaces begin apart, or touching
        limit = ONTO * model.size if group.is_unilateral else 0.5 * thick
        excess = depth - limit
        for i in np.flatnonzero(excess > 0.0):
            card = model.contacts[group.parameters["card"][i]]
            if excess[i] > worst.get(card, 0.0):
                worst[card], messages[card] = excess[i], _overlap(engine, group, int(i))
    for nodal in model.nodal_groups:
        depth = nodal.arrays["totals"]["depth"][0]
        if nodal.narrow is None and depth > ONTO * model.size:
            messages[nodal.card] = (
                f"begins {depth:.3g} m deep: nodes are nearer to faces than their common "
                "thickness; move them apart, or set `ring` if they are neighbours in the mesh"
            )
    return list(messages.items())


def _overlap(engine: Engine, group: ContactGroup, pair: int) -> str:
    """The cause that a pair of elements begins too deep."""
    depth = group.history["depth"][int(engine.clock["current"])][pair]
    a, b = bodies_of_pair(engine.model, group, pair)
    why = (
        "but nodes of a unilateral constraint must not begin inside"
        if group.is_unilateral
        else f"more than half of the {group.parameters['thick'][pair]:.3g} m from the middle of "
        "one side to the middle of the other"
    )
    return f"{a} on {b} begins {depth:.3g} m deep, {why}"
