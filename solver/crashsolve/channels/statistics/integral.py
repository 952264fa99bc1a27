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
    """Simpson's rule for pairs of intervals; an odd interval at the end stays as it is.

    So do pairs of which one is several times the other, as where steps are sampled after a long
    interval: no parabola passes through both.
    """
    time, values = series.time, series.values
    fine = cumulative(time, values)
    last = (len(time) - 1) // 2 * 2
    a, b = np.diff(time[: last + 1])[::2], np.diff(time[: last + 1])[1::2]
    x, y, z = values[0:last:2], values[1:last:2], values[2 : last + 1 : 2]
    # the parabola through three samples: its bend times this
    bend = (z - y) / b - (y - x) / a
    is_even = np.maximum(a, b) <= MAX_RATIO * np.minimum(a, b)
    return float(fine[-1] - np.sum(np.where(is_even, bend * (a**3 + b**3) / (6.0 * (a + b)), 0.0)))


def unit(unit: str) -> str:
    """The unit of the values times the second."""
    return str(Product.parse(unit).times(Product.parse("s")))


def scale(series: Series, size: float) -> float:
    """The largest magnitude, held for the whole time."""
    return float(cumulative(series.time, np.full(len(series.time), size))[-1])
