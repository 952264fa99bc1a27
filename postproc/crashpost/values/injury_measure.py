"""A measure of injury with its limit, and its error by the samples that it is computed from.

The error is the largest difference to the same measure of every second sample, in whose place
straight lines are drawn between its neighbours, of both halves of the samples. Of a history that
the samples resolve it is some three times the true error, as all measures are of second order in
the interval; of a pulse within an interval it is of the size of the measure.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values.units import unit_text
from crashsolve.channels.coarse import every_second
from crashsolve.channels.display import factor
from crashsolve.channels.series import Series

HEADER = ("", "measure", "value", "error of samples", "limit", "source", "verdict", "when")
# units to show SI units in
USUAL = {"m": "mm", "N": "kN", "m/s^2": "g0", "s": "ms"}
# columns of numbers
NUMERIC = ("value", "error of samples", "limit")


class Measure(NamedTuple):
    """One row of the table: a number in its SI unit, None for a remark or where there is none.

    `times` [s] take the places of braces in `when`. `limit` is that of the regulation `source`;
    `missing` states why the value may not be compared with it, such as samples too few for the
    filter class that the measure is defined with.
    """

    name: str
    measure: str
    value: float | None = None
    unit: str = ""
    when: str = ""
    limit: float | None = None
    source: str = ""
    missing: str = ""
    times: tuple[float, ...] = ()


class EverySecond(Result):
    """A result of which straight lines between every second sample remain, from `first` on."""

    def __init__(self, result: Result, first: int) -> None:
        self.__dict__.update(result.__dict__)
        self._first = first

    def _channel(self, name: str) -> Series:
        time, values, unit = super()._channel(name)
        if name != "time":
            values = every_second(time, values, self._first)
        return Series(time, values, unit)


def rows(
    result: Result,
    measures: Callable[[Result], list[Measure]],
    units: Mapping[str, str] = USUAL,
) -> list[list[str]]:
    """The measures of a result as text, with their errors, under HEADER.

    `units` are those to show SI units in; others stay as they are.
    """
    own = measures(result)
    coarse = [measures(EverySecond(result, first)) for first in (0, 1)]
    errors = [_error(one, same) for one, *same in zip(own, *coarse, strict=True)]
    return [_row(one, error, units) for one, error in zip(own, errors, strict=True)]


def _error(own: Measure, coarse: list[Measure]) -> float | None:
    """Largest difference to the others, None where one of them has no value."""
    values = [one.value for one in coarse]
    known = [value for value in values if value is not None]
    if own.value is None or len(known) < len(values):
        return None
    return max(abs(value - own.value) for value in known)


def _row(one: Measure, error: float | None, units: Mapping[str, str]) -> list[str]:
    size, unit = _shown(one.unit, units)
    value = "" if one.value is None and not one.unit else "-"
    value = value if one.value is None else f"{number(one.value * size)} {unit}".rstrip()
    shown = "" if error is None else f"{error * size:.2g} {unit}".rstrip()
    limit = "" if one.limit is None else f"{number(one.limit * size)} {unit}".rstrip()
    when = _when(one, *_shown("s", units))
    return [one.name, one.measure, value, shown, limit, one.source, verdict(one, error), when]


def _shown(unit: str, units: Mapping[str, str]) -> tuple[float, str]:
    """Factor on numbers in an SI unit, and the unit that they then have, as printed."""
    wanted = units.get(unit, unit)
    return factor(unit, wanted), unit_text(wanted)


def _when(one: Measure, size: float, unit: str) -> str:
    if not one.times:
        return one.when
    return one.when.format(*(f"{number(time * size)} {unit}" for time in one.times))


def verdict(one: Measure, error: float | None) -> str:
    """Whether a measure is within its limit, for more than the error of its samples."""
    if one.limit is None or one.value is None:
        return ""
    if one.missing:
        return f"not assessed: {one.missing}"
    if error is not None and abs(one.value - one.limit) < error:
        return "uncertain: within the error"
    return "within" if one.value <= one.limit else "beyond"
