"""Words that all curves share, and the checks of points."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

from crashsolve.deck.card import Card, word
from crashsolve.deck.mistakes import refuse

# as foundation/curve.py counts them
EXTRAPOLATE = {"refuse": 0, "hold": 1, "linear": 2}

Points = tuple[tuple[float, float], ...]


class CurveCard(Card):
    """What a curve does outside its points."""

    extrapolate: Literal["refuse", "hold", "linear"] = word(
        "outside its range: refuse stops the run, hold keeps the end value, linear the end slope",
        "refuse",
    )


class PointsCard(CurveCard):
    """How a curve goes through its points, and their units."""

    x_unit: str | None = word("unit of x; SI when absent", None)
    y_unit: str | None = word("unit of y; SI when absent", None)
    interpolation: Literal["linear", "smooth", "cubic"] = word(
        "between points: straight, smooth without overshoot, or natural cubic spline", "linear"
    )


def check_order(points: Sequence[tuple[float, float]], field: str) -> None:
    """Refuse points unless there are two or more, in order of x."""
    if len(points) < 2:
        refuse("a curve needs at least 2 points", within=(field,))
    for i, ((before, _), (x, _)) in enumerate(pairwise(points), start=1):
        if x == before:
            advice = "a vertical jump has no slope; move one of the two points a little"
            refuse(f"x = {x:g} appears twice", advice, within=(field, i))
        if x < before:
            advice = "order the points by x"
            refuse(f"x = {x:g} comes after {before:g}", advice, within=(field, i))
