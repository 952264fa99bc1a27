"""Toy joint."""

from crashsolve.deck.card import BodyName, Card, word


class Planar(Card):
    """Planar joint."""

    b: BodyName = word("second body")
