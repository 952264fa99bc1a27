"""Words that all curves share, and the checks of points."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

from crashsolve.channels.units import Unit, describe, parse_unit
from crashsolve.deck.card import Card, word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context

# as foundation/curve.py counts them
EXTRAPOLATE = {"refuse": 0, "hold": 1, "linear": 2}

Points = tuple[tuple[float, float], ...]


class CurveCard(Card):
    """Fields of all curves: the extrapolation outside their points."""

    extrapolate: Literal["refuse", "hold", "linear"] = word(
        "outside its range: refuse stops the run, hold keeps the end value, linear the end slope",
        "refuse",
    )


class PointsCard(CurveCard):
    """Interpolation of a curve through its points, and their units."""

    x_unit: str | None = word("unit of x; when absent that of the file, by the curve's use", None)
    y_unit: str | None = word("unit of y; when absent that of the file, by the curve's use", None)
    interpolation: Literal["linear", "smooth", "cubic"] = word(
        "between points: straight, smooth without overshoot, or natural cubic spline", "linear"
    )


def check_axis(unit: Unit | None, j: int, name: str, context: Context) -> None:
    """Refuse x or y in a unit of another dimension than its use has; a factor may have any."""
    wanted = context.axes[j] if context.axes else "1"
    if unit is None or wanted == "1":
        return
    if unit.exponents != parse_unit(wanted).exponents:
        axis = "xy"[j]
        message = f"{axis} is in {describe(unit)}, but the curve is used with {axis} in {wanted}"
        is_gravity = (unit, wanted) == (parse_unit("g"), "m/s^2")
        refuse(message, "standard gravity is 'g0'" * is_gravity, within=(name,))


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
