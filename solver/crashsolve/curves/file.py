"""Curve through the points of a text file with columns.

    y(x_i) = y_i, as in table.py

Columns are parted by semicolons, by commas, or by tabs and spaces: a line with several of them has
the first of these between its columns, so that a decimal comma is never read as a separator. Lines
that begin with # are skipped, and so are headings above the numbers.
Consequence to test: the same points give the same curve as a table.
"""

import math
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pydantic import ValidationInfo, model_validator

from crashsolve.channels.units import PURE, SI
from crashsolve.curves._card import EXTRAPOLATE, PointsCard, check_axis, check_order
from crashsolve.curves._piecewise import Array, coefficients
from crashsolve.deck.building import Scene
from crashsolve.deck.card import FileName, word
from crashsolve.deck.diagnostics import refuse
from crashsolve.deck.numbers import Context, unit_named

DECIMAL_COMMA = "write decimal points in place of commas"


class File(PointsCard):
    """Curve through points read from a text file with columns."""

    file: FileName = word("file of points, beside the deck that names it")
    columns: tuple[int, int] = word("columns of x and y, counted from 1", (1, 2), ge=1)

    @model_validator(mode="before")
    @classmethod
    def _units_by_use(cls, given: object, info: ValidationInfo) -> object:
        """Units that are not given are those of the deck's file, where the use states which."""
        if not isinstance(given, Mapping):
            return given
        context = info.context or Context()
        units = {name: context.unit_of_axis(j) for j, name in enumerate(("x_unit", "y_unit"))}
        return {**{name: unit for name, unit in units.items() if unit}, **given}

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> "File":
        context = info.context or Context()
        for j, name in enumerate(("x_unit", "y_unit")):
            unit = getattr(self, name)
            if unit is None and context.units is not SI:
                refuse("must be given, as this deck has units of its own", within=(name,))
            check_axis(None if unit is None else unit_named(unit, (name,)), j, name, context)
        check_order(read_columns(self.file, self.columns), "file")
        return self


def read_columns(file: str, columns: tuple[int, int]) -> list[tuple[float, float]]:
    """Points (x, y) of a file as they stand in it."""
    try:
        lines = Path(file).read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        refuse(f"'{file}' cannot be read", str(error), within=("file",))
    points: list[tuple[float, float]] = []
    for row, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = _cells(line)
        point = tuple(_number(cells, column) for column in columns)
        if all(map(math.isfinite, point)):
            points.append((point[0], point[1]))
        elif points or _has_decimal_comma(cells):
            message = f"line {row} of '{file}' has no two numbers in these columns"
            refuse(message, DECIMAL_COMMA * _has_decimal_comma(cells), within=("file",))
    if not points:
        refuse(f"no line of '{file}' has two numbers in these columns", within=("file",))
    return points


def _cells(line: str) -> list[str]:
    """Texts of a line's columns."""
    mark = next((mark for mark in ";," if mark in line), None)
    return [cell.strip() for cell in line.split(mark)]


def _has_decimal_comma(cells: list[str]) -> bool:
    """Whether a cell is a number with a comma, or two parts of numbers with blanks between."""
    number = r"[-+]?\d+,\d+([eE][-+]?\d+)?|[-+]?\d+\s+[-+]?\d+"
    return any(re.fullmatch(number, cell) for cell in cells)


def _number(cells: list[str], column: int) -> float:
    """Number in a cell; NaN when there is none."""
    try:
        return float(cells[column - 1])
    except (ValueError, IndexError):
        return math.nan


def build(card: File, scene: Scene) -> tuple[Array, Array, int]:
    """Breakpoints (n,), coefficients (n - 1, 4) and the code of extrapolation."""
    x, y = np.array(read_columns(card.file, card.columns)).T
    x = x * _factor(card.x_unit)
    y = y * _factor(card.y_unit)
    return x, coefficients(x, y, card.interpolation), EXTRAPOLATE[card.extrapolate]


def _factor(unit: str | None) -> float:
    return PURE.factor if unit is None else unit_named(unit, ()).factor
