"""Toy law."""

from crashsolve.deck.card import Card, quantity


class Hertz(Card):
    """Hertz."""

    exponent: float = quantity("1", "power", 1.5, gt=0)
    stiffness: float = quantity("N/m^{exponent}", "stiffness", gt=0)
