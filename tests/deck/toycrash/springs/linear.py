"""Toy spring."""

from crashsolve.deck.card import BodyName, Card, quantity, word


class Linear(Card):
    """Linear spring."""

    a: BodyName = word("first body", "ground")
    b: BodyName = word("second body")
    stiffness: float = quantity("N/m", "slope", gt=0)


def build(card: Linear, scene: object) -> dict[str, object]:
    """What a law of the family provides; toys are only read."""
    raise NotImplementedError


def force(p, old, new, out, t, h, nodes, rows, curves):
    """The same."""
    raise NotImplementedError
