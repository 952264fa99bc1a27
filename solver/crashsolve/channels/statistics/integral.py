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

    Where one interval of a pair is several times the other, as where steps are sampled after a long
    interval, no parabola passes through both: the slope of the short one continues into the other.
    """
    time, values = series.time, series.values
    fine = cumulative(time, values)
    last = (len(time) - 1) // 2 * 2
    a, b = np.diff(time[: last + 1])[::2], np.diff(time[: last + 1])[1::2]
    x, y, z = values[0:last:2], values[1:last:2], values[2 : last + 1 : 2]
    # the parabola through three samples: its bend times this
    bend = (z - y) / b - (y - x) / a
    is_even = np.maximum(a, b) <= MAX_RATIO * np.minimum(a, b)
    is_first = a > b
    rise = np.where(is_first, (y - z) / b, (y - x) / a)
    uneven = _beside_short(np.maximum(a, b), np.where(is_first, x, z) - y, rise)
    even = -bend * (a**3 + b**3) / (6.0 * (a + b))
    return float(fine[-1] + np.sum(np.where(is_even, even, uneven)) + _of_odd_end(time, values))


def _of_odd_end(time: np.ndarray, values: np.ndarray) -> float:
    """Integral less its trapezoid of a last interval without a pair, several times the one before;
    0 of others.
    """
    spans = np.diff(time[-3:])
    if len(time) % 2 or len(time) < 4 or spans[1] <= MAX_RATIO * spans[0]:
        return 0.0
    before, change = np.diff(values[-3:])
    return float(_beside_short(spans[1:], np.array([change]), np.array([before / spans[0]]))[0])


def _beside_short(span: np.ndarray, change: np.ndarray, rise: np.ndarray) -> np.ndarray:
    """Integral over long intervals (n,) less that of their trapezoids.

    A history begins them with the slope `rise` and ends them with `change` more: a parabola, or
    with a steep slope a straight line that ends in a constant.
    """
    is_smooth = np.abs(rise) * span <= 2.0 * np.abs(change)
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
