"""Fields that the cards of friction laws share."""

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card


def columns(card: Card, scene: Scene) -> Columns:
    """Every field of a card as the column of PARAMETERS named after it, in SI units."""
    return {f"friction_{name}": value for name, value in card}
