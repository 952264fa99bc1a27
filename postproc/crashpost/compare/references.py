"""Our value beside the published one, for every reference that names a channel."""

from dataclasses import dataclass

import numpy as np

from crashpost.compare.corridors import compare_with_corridor
from crashpost.results.result import Result
from crashpost.values.figure import Figure, Reference
from crashsolve.channels.display import factor
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import is_a_time, statistic, unit_of


@dataclass(frozen=True)
class Comparison:
    """One number of the run against a published number or range, in the unit shown."""

    label: str
    source: str
    computed: float
    low: float
    high: float
    unit: str
    tolerance: float | None = None

    @property
    def difference(self) -> float:
        """Ours minus the nearest published value; 0 inside a range."""
        return self.computed - min(max(self.computed, self.low), self.high)

    @property
    def percent(self) -> float | None:
        """The difference in % of the nearest published value, None when that is 0."""
        nearest = min(max(self.computed, self.low), self.high)
        return 100 * self.difference / abs(nearest) if nearest else None

    @property
    def missed(self) -> bool | None:
        """Whether the value is outside the published range; None where no range is given."""
        if self.low == self.high and self.tolerance is None:
            return None
        return abs(self.difference) > (self.tolerance or 0.0)

    @property
    def published(self) -> str:
        """The published number or range as people write it."""
        known = f" ± {self.tolerance:.4g}" if self.tolerance is not None else ""
        if self.low == self.high:
            return f"{self.low:.6g}{known}"
        return f"{self.low:.6g} to {self.high:.6g}{known}"


def comparisons(result: Result, figure: Figure) -> list[Comparison]:
    """One comparison for every reference with a channel, in the figure's order."""
    return [_compare(result, figure, ref) for ref in figure.reference if ref.channel]


def _compare(result: Result, figure: Figure, reference: Reference) -> Comparison:
    series = result.series(reference.channel)
    if reference.kind == "corridor":
        return _beside_corridor(series, figure, reference)
    if is_a_time(reference.statistic):
        on_time = figure.x == "time"
        unit = (figure.x_unit if on_time else "") or "s"
        offset = figure.x_offset if on_time else 0.0
        moment = statistic(series, reference.statistic, reference.during)
        computed = moment * factor("s", unit) + offset
    else:
        unit = figure.y_unit or series.unit
        shown = series.values * factor(series.unit, unit) + figure.y_offset
        series = Series(series.time, shown, unit)
        computed = statistic(series, reference.statistic, reference.during)
        unit = unit_of(reference.statistic, unit)
    low, high = _published(reference)
    return Comparison(
        reference.label, reference.source, computed, low, high, unit, reference.tolerance
    )


def _beside_corridor(series: Series, figure: Figure, reference: Reference) -> Comparison:
    """Largest distance of a history from a corridor over time, and its duration."""
    unit, x_unit = figure.y_unit or series.unit, figure.x_unit or "s"
    time = series.time * factor("s", x_unit) + figure.x_offset
    values = series.values * factor(series.unit, unit) + figure.y_offset
    lower, upper = (np.array(border).T for border in (reference.points, reference.upper))
    during = reference.during
    if during is not None:
        first, last = (end * factor("s", x_unit) + figure.x_offset for end in during)
        during = first, last
    excess = compare_with_corridor(
        (time, values), (lower[0], lower[1]), (upper[0], upper[1]), during
    )
    label = f"{reference.label}: largest excess, inside for {100 * excess.inside:.4g} % of the time"
    known = reference.tolerance or 0.0
    return Comparison(label, reference.source, excess.excess, 0.0, 0.0, unit, known)


def _published(reference: Reference) -> tuple[float, float]:
    """The published value as a range; of points, the range of their ordinates."""
    if reference.kind == "level" and reference.value is not None:
        return reference.value, reference.value
    if reference.from_ is not None and reference.to is not None:
        return min(reference.from_, reference.to), max(reference.from_, reference.to)
    axis = 0 if is_a_time(reference.statistic) else 1
    numbers = np.array(reference.points)[:, axis]
    return float(numbers.min()), float(numbers.max())
