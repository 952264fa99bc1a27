"""Toy surface."""

from crashsolve.deck.card import Card


class Plane(Card):
    """Plane."""
