"""Integral over time, from the first sample to the last, by the trapezoidal rule."""

import numpy as np

from crashsolve.channels.display import Product
from crashsolve.channels.series import Series, cumulative

# intervals that differ by more than this have no parabola in common
MAX_RATIO = 4.0


def value(series: Series) -> float:
    """The integral by trapezoids."""
    return float(cumulative(series.time, series.values)[-1])


def refined(series: Series) -> float:
    """Simpson's rule for pairs of intervals; an odd interval at the end stays a trapezoid.

    Where an interval is several times its neighbour, as where steps are sampled after a long
    interval, no parabola passes through both: the slope of the short one continues into the other.
    """
    time, values = series.time, series.values
    fine = float(cumulative(time, values)[-1])
    spans, changes = np.diff(time), np.diff(values)
    before, after = np.full(len(spans), np.inf), np.full(len(spans), np.inf)
    before[1:], after[:-1] = spans[:-1], spans[1:]
    is_long = spans > MAX_RATIO * np.minimum(before, after)
    long = np.flatnonzero(is_long)
    # seen from the shorter neighbour, in time or against it
    is_ahead = after[long] <= before[long]
    near = np.where(is_ahead, long + 1, long - 1)
    sign = np.where(is_ahead, -1.0, 1.0)
    rises = sign * changes[near] / spans[near]
    corrections = _beside_short(spans[long], sign * changes[long], rises)
    last = len(spans) // 2 * 2
    a, b = spans[:last:2], spans[1:last:2]
    # the parabola through three samples: its bend times this
    bend = changes[1:last:2] / b - changes[:last:2] / a
    is_even = ~(is_long[:last:2] | is_long[1:last:2])
    simpson = np.where(is_even, -bend * (a**3 + b**3) / (6.0 * (a + b)), 0.0)
    return fine + float(simpson.sum() + corrections.sum())


def _beside_short(span: np.ndarray, change: np.ndarray, rise: np.ndarray) -> np.ndarray:
    """Integral over long intervals (n,) less that of their trapezoids.

    A history begins them with the slope `rise` and ends them with `change` more: a parabola, with a
    steep slope a straight line that ends in a constant, with one of the other sign a jump to it.
    """
    is_smooth = (np.abs(rise) * span <= 2.0 * np.abs(change)) & (rise * change >= 0.0)
    parabola = (rise * span - change) * span / 6.0
    with np.errstate(divide="ignore", invalid="ignore"):
        until = np.where(change == 0.0, 0.0, np.clip(change / rise, 0.0, span))
    return np.where(is_smooth, parabola, 0.5 * change * (span - until))


def unit(unit: str) -> str:
    """The unit of the values times the second."""
    return str(Product.parse(unit).times(Product.parse("s")))


def scale(series: Series, size: float) -> float:
    """The largest magnitude, held for the whole time."""
    return float(cumulative(series.time, np.full(len(series.time), size))[-1])
