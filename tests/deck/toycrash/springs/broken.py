"""Toy spring whose module cannot be imported: only a deck that uses it may notice."""

from crashsolve.deck.card import Card

raise RuntimeError("imported without need")


class Broken(Card):
    """Spring that no deck uses."""
