"""Fields that the cards of friction laws share."""

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card


def columns(card: Card, scene: Scene) -> Columns:
    """Every field of a card as a column of PARAMETERS, in SI units.

    Its name begins with `friction_`, as the row of a pair has the columns of its normal law too.
    """
    return {f"friction_{name.removeprefix('friction_')}": value for name, value in card}
