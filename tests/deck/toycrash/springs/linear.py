"""Toy spring."""

from crashsolve.deck.card import BodyName, Card, quantity, word


class Linear(Card):
    """Linear spring."""

    a: BodyName = word("first body", "ground")
    b: BodyName = word("second body")
    stiffness: float = quantity("N/m", "slope", gt=0)
