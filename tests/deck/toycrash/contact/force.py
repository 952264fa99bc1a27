"""Toy contact."""

from crashsolve.deck.card import Card, Law, SurfaceName, word


class Force(Card):
    """Contact."""

    a: tuple[SurfaceName, ...] = word("surfaces")
    b: tuple[SurfaceName, ...] = word("surfaces")
    normal: Card = Law("contact/normal", "law of the normal force")
