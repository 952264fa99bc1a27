"""Toy load."""

from crashsolve.deck.card import Card, Vec3, quantity


class Gravity(Card):
    """Gravity."""

    acceleration: Vec3 = quantity("m/s^2", "free fall", (0.0, 0.0, -9.81))
