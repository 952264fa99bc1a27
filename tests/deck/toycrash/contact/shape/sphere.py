"""Toy surface."""

from crashsolve.deck.card import BodyName, Card, quantity, word


class Sphere(Card):
    """Sphere."""

    body: BodyName = word("body")
    radius: float = quantity("m", "radius", gt=0)
