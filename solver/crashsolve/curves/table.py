"""Curve through the points of a table.

    y(x_i) = y_i; between points straight, smooth without overshoot, or a natural cubic spline

Consequence to test: the curve hits every point, and a cubic curve has no kink.
References: see _piecewise.py.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import ValidationInfo, model_validator

from crashsolve.channels.units import PURE, Unit, UnitError, describe
from crashsolve.curves._card import EXTRAPOLATE, Points, PointsCard, check_axis, check_order
from crashsolve.curves._piecewise import Array, coefficients
from crashsolve.deck.building import Scene
from crashsolve.deck.card import word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context, SiFloat, number_in, refuse_foreign, unit_named


class Table(PointsCard):
    """Curve through points, in order of x."""

    points: Points = word("[x, y] of each point, in x_unit and y_unit or each with its unit")

    @model_validator(mode="before")
    @classmethod
    def _points_to_si(cls, given: Any, info: ValidationInfo) -> object:
        """Points in SI, with the units that they then have."""
        points = given.get("points") if isinstance(given, Mapping) else None
        if not isinstance(points, list | tuple) or not all(map(_is_pair, points)):
            return given
        context = info.context or Context()
        fields = dict(given)
        columns = []
        for j, name in enumerate(("x_unit", "y_unit")):
            unit = None if fields.get(name) is None else unit_named(fields[name], (name,))
            column, unit = _column([point[j] for point in points], j, unit, context)
            check_axis(unit, j, name, context)
            columns.append(column)
            fields[name] = None if unit is None else describe(unit)
        fields["points"] = tuple(zip(*columns, strict=True))
        return fields

    @model_validator(mode="after")
    def _points_in_order(self) -> "Table":
        check_order(self.points, "points")
        return self


def _is_pair(point: object) -> bool:
    return isinstance(point, list | tuple) and len(point) == 2


def _column(
    values: list[object], j: int, named: Unit | None, context: Context
) -> tuple[list[float], Unit | None]:
    """A column in SI, and its unit: the one named, else that of the first value which has one.

    Bare numbers of a file with units of its own are in these, where the use states the dimension.
    """
    column, unit = [], named
    by_use = context.unit_of_axis(j) if named is None else None
    for i, value in enumerate(values):
        is_bare = by_use and isinstance(value, int | float) and not isinstance(value, SiFloat)
        given = unit_named(by_use, ()) if is_bare else named
        if is_bare:
            _refuse_foreign(value, given, ("points", i, j))
        number, own = number_in(value, given, context, ("points", i, j))
        unit = unit or own
        if unit and own and own.exponents != unit.exponents:
            refuse(f"this is in {describe(own)}, not in {describe(unit)}", within=("points", i, j))
        column.append(number)
    return column, unit


def _refuse_foreign(value: float, unit: Unit | None, within: tuple[str | int, ...]) -> None:
    """Refuse a bare number that counts in the units of another file."""
    try:
        refuse_foreign(value, unit or PURE)
    except UnitError as error:
        refuse("must be a number, alone or with a unit", str(error), within=within)


def build(card: Table, scene: Scene) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    x, y = np.array(card.points).T
    return x, coefficients(x, y, card.interpolation), EXTRAPOLATE[card.extrapolate]
