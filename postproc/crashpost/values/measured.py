"""Curves measured in a test, with corridors, from text files with a column for each.

    time [ms], pole force [kN], lower [kN], upper [kN]
    0,         0.2,             -1,         2

The first line names the columns with their units; the first column is the abscissa. Columns `lower`
and `upper` are the corridor. Columns are parted by commas, semicolons or tabs.
"""

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crashpost.errors import PostError
from crashsolve.channels.display import Product, factor, is_convertible
from crashsolve.channels.errors import ChannelError

_HEAD = re.compile(r"\s*(.*?)\s*\[(.*)\]\s*")
LOWER, UPPER = "lower", "upper"
NO_UNIT = ("", "-")


@dataclass(frozen=True)
class Column:
    """One column of a test."""

    name: str
    unit: str
    values: np.ndarray


@dataclass(frozen=True)
class Measurement:
    """A test: abscissa, measured curves, and where there is one the corridor (lower, upper)."""

    name: str
    abscissa: Column
    curves: tuple[Column, ...]
    corridor: tuple[Column, Column] | None = None

    def fits(self, x_unit: str, y_unit: str) -> bool:
        """Whether something of it can be drawn over axes of these units."""
        return is_convertible(self.abscissa.unit, x_unit) and any(
            is_convertible(column.unit, y_unit) for column in self.columns
        )

    @property
    def columns(self) -> tuple[Column, ...]:
        """The curves and the borders of the corridor."""
        return (*self.curves, *(self.corridor or ()))

    def points(self, column: Column, x_unit: str, y_unit: str) -> tuple[tuple[float, float], ...]:
        """A column over the abscissa in the requested units; raises PostError."""
        x = self.abscissa.values * factor(self.abscissa.unit, x_unit)
        y = column.values * factor(column.unit, y_unit)
        return tuple(zip(x.tolist(), y.tolist(), strict=True))


def read_test(path: Path) -> Measurement:
    """The test in a file; raises PostError naming file, line and cause."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise PostError(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    # lines of remarks and empty ones keep their numbers
    rows = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    if len(rows) < 3:
        raise PostError(f"{path}: a line of names and at least two lines of numbers are needed")
    mark = next((mark for mark in (";", "\t", ",") if mark in rows[0][1]), ",")
    heads = [_head(path, rows[0][0], text) for text in _cells(rows[0][1], mark)]
    if len(heads) < 2:
        raise PostError(f"{path}:{rows[0][0]}: at least two columns are needed")
    table = np.array([_numbers(path, n, line, mark, len(heads)) for n, line in rows[1:]]).T
    return _test(path, [Column(*head, values) for head, values in zip(heads, table, strict=True)])


def _test(path: Path, columns: list[Column]) -> Measurement:
    abscissa, *others = columns
    if abscissa.unit and is_convertible(abscissa.unit, "s"):
        back = np.flatnonzero(np.diff(abscissa.values) <= 0)
        if len(back):
            raise PostError(f"{path}: times must increase, not so after row {back[0] + 1}")
    borders = {c.name.lower(): c for c in others if c.name.lower() in (LOWER, UPPER)}
    if len(borders) == 1:
        raise PostError(f"{path}: a corridor has two columns, lower and upper")
    corridor = None
    if borders:
        corridor = (borders[LOWER], borders[UPPER])
        if corridor[0].unit != corridor[1].unit:
            raise PostError(f"{path}: lower and upper must have one unit")
        if np.any(corridor[0].values > corridor[1].values):
            raise PostError(f"{path}: lower is above upper in some row")
    curves = tuple(column for column in others if column.name.lower() not in (LOWER, UPPER))
    return Measurement(path.stem.replace("_", " "), abscissa, curves, corridor)


def _cells(line: str, mark: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=mark))]


def _head(path: Path, number: int, text: str) -> tuple[str, str]:
    """Name and unit of a column."""
    match = _HEAD.fullmatch(text)
    if match is None or not match[1]:
        raise PostError(f"{path}:{number}: name columns as 'force [kN]', not '{text}'")
    unit = "" if match[2].strip() in NO_UNIT else match[2].strip()
    # a channel without unit is shown as a pure number
    try:
        Product.parse(unit)
    except ChannelError as error:
        raise PostError(f"{path}:{number}: '{text}': {error}") from error
    return match[1], unit


def _numbers(path: Path, number: int, line: str, mark: str, width: int) -> list[float]:
    cells = _cells(line, mark)
    if len(cells) != width:
        raise PostError(f"{path}:{number}: {len(cells)} columns where the first line has {width}")
    try:
        numbers = [float(cell) for cell in cells]
    except ValueError as error:
        raise PostError(f"{path}:{number}: {error}") from None
    if not all(map(math.isfinite, numbers)):
        raise PostError(f"{path}:{number}: a value is not finite")
    return numbers
