"""The units of a page: those requested, and one for each kind of number on all of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashpost.values.figure import AUTO, Figure, Pair, Reference, axis_unit
from crashsolve.channels.display import Product, factor, is_convertible, readable
from crashsolve.channels.statistic import is_a_time


@dataclass(frozen=True)
class Units:
    """Units by channel or pattern, and units for all that they can measure, such as kN and ms."""

    of_channel: dict[str, str] = field(default_factory=dict)
    of_all: tuple[str, ...] = ()

    @classmethod
    def read(cls, words: Sequence[str]) -> "Units":
        """Units from words `CHANNEL=UNIT`, or `kN,ms`; raises PostError for an unknown unit."""
        named, general = dict[str, str](), list[str]()
        for word in words:
            channel, equals, unit = word.rpartition("=")
            if equals and not (channel.strip() and unit):
                raise PostError(f"--unit takes CHANNEL=UNIT or UNIT, not '{word}'")
            if equals:
                named[channel.strip()] = unit
            else:
                general += [part.strip() for part in word.split(",") if part.strip()]
        for unit in (*named.values(), *general):
            Product.parse(unit)
        return cls(named, tuple(general))

    def requested(self, channel: str) -> str:
        """The unit requested for a channel by name or pattern; "" where none is."""
        return next((unit for name, unit in self.of_channel.items() if fits(name, channel)), "")

    def wanted(self, channel: str, unit: str) -> str:
        """The unit in which to show a channel that has `unit`; "" where any will do."""
        return self.requested(channel) or next(
            (u for u in self.of_all if unit not in ("", "1") and is_convertible(unit, u)), ""
        )

    def check_used(self, channels: Sequence[str]) -> None:
        """Raises PostError for a name or pattern that fits none of the channels shown."""
        for name in self.of_channel:
            if not any(fits(name, channel) for channel in channels):
                raise PostError(f"--unit names '{name}', which is not drawn")


def unit_text(unit: str) -> str:
    """A unit as it is printed: m/s², g, nothing for a pure number."""
    return {"deg": "°", "g0": "g", "1": ""}.get(unit, unit.replace("^2", "²").replace("^3", "³"))


def fits(name: str, channel: str) -> bool:
    """Whether a name or pattern is that of a channel."""
    return name == channel or fnmatchcase(channel, name)


def page_time_unit(result: Result, figures: Sequence[Figure], units: Units) -> str:
    """The page's unit of time: the reader's, else that of its first figure, else a fitting one."""
    requested = units.wanted("time", "s")
    stated = [f.x_unit for f in figures if f.x == "time" and f.x_unit not in ("", AUTO)]
    longest = float(np.max(np.abs(result.time), initial=0.0))
    return requested or (stated[0] if stated else readable("s", longest))


class PageUnits:
    """The unit of charts and tables by the SI unit of their values: that of the first figure.

    What no figure of the page shows stays in SI.
    """

    def __init__(
        self, result: Result, figures: Sequence[Figure], units: Units, time_unit: str
    ) -> None:
        self.of = {"s": time_unit}
        for figure in figures if len(result.time) else ():
            x = [curve.x or figure.x for curve in figure.y]
            y = [curve.channel for curve in figure.y]
            for channels, stated in ((y, figure.y_unit), (x, figure.x_unit)):
                try:
                    series = [result.series(channel) for channel in channels]
                    unit = units.wanted(channels[0], series[0].unit) or axis_unit(series, stated)
                    factor(series[0].unit, unit)
                except PostError:
                    # the figure itself reports this
                    continue
                if series[0].unit not in ("", "1"):
                    self.of.setdefault(series[0].unit, unit)

    def unit(self, own: str) -> str:
        """The page's unit for values in this unit, as it is printed."""
        return unit_text(self.of.get(own, own))

    def size(self, own: str) -> float:
        """Factor on numbers in this unit."""
        return factor(own, self.of[own]) if own in self.of else 1.0


def on_page(
    result: Result,
    figure: Figure,
    units: Units,
    time_unit: str,
    page: Mapping[str, str] | None = None,
) -> Figure:
    """A figure in the page's unit of time and the reader's units, its references with it.

    `page` has the units by SI unit of figures that state none.
    """
    x_own = result.series(figure.y[0].x or figure.x).unit
    y_own = result.series(figure.y[0].channel).unit
    is_time = figure.x == "time" and not any(curve.x for curve in figure.y)
    x_unit = time_unit if is_time else units.wanted(figure.y[0].x or figure.x, x_own)
    y_unit = units.wanted(figure.y[0].channel, y_own)
    if page and figure.x_unit == AUTO:
        x_unit = x_unit or page.get(x_own, "")
    if page and figure.y_unit == AUTO:
        y_unit = y_unit or page.get(y_own, "")
    if x_unit:
        figure = _along_x(figure, _ratio(figure.x_unit, x_own, x_unit), x_unit)
    if y_unit:
        figure = _along_y(figure, _ratio(figure.y_unit, y_own, y_unit), y_unit)
    return figure


def _ratio(present: str, own: str, wanted: str) -> float:
    """Factor on numbers of an axis; those in an automatic unit are in its own."""
    return factor(own if present in ("", AUTO) else present, wanted)


def _along_x(figure: Figure, size: float, unit: str) -> Figure:
    references = tuple(
        replace(
            r,
            points=_scaled(r.points, size, 1.0),
            upper=_scaled(r.upper, size, 1.0),
            over=r.over and _pair(r.over, size),
            tolerance=_tolerance(r, size, along_time=True),
        )
        for r in figure.reference
    )
    ends = figure.x_range and _pair(figure.x_range, size)
    offset = figure.x_offset * size
    return replace(figure, x_unit=unit, x_offset=offset, x_range=ends, reference=references)


def _along_y(figure: Figure, size: float, unit: str) -> Figure:
    references = tuple(_reference_along_y(r, size) for r in figure.reference)
    ends = figure.y_range and _pair(figure.y_range, size)
    offset = figure.y_offset * size
    return replace(figure, y_unit=unit, y_offset=offset, y_range=ends, reference=references)


def _reference_along_y(reference: Reference, size: float) -> Reference:
    numbers: dict[str, Any] = {
        name: None if value is None else value * size
        for name in ("value", "from_", "to")
        for value in (getattr(reference, name),)
    }
    numbers["tolerance"] = _tolerance(reference, size, along_time=False)
    points, upper = (_scaled(p, 1.0, size) for p in (reference.points, reference.upper))
    return replace(reference, points=points, upper=upper, **numbers)


def _tolerance(reference: Reference, size: float, *, along_time: bool) -> float | None:
    """The tolerance when numbers along one axis are multiplied: of a moment it lies along time."""
    is_moment = bool(reference.statistic) and is_a_time(reference.statistic)
    if reference.tolerance is None or is_moment != along_time:
        return reference.tolerance
    return reference.tolerance * size


def _scaled(points: tuple[Pair, ...], x: float, y: float) -> tuple[Pair, ...]:
    return tuple((a * x, b * y) for a, b in points)


def _pair(ends: Pair, size: float) -> Pair:
    return ends[0] * size, ends[1] * size
