"""Largest magnitude of a sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import above, isolated, magnitude, negative, top


def value(series: Series) -> float:
    """The largest magnitude of the samples."""
    return float(np.max(np.abs(series.values)))


def refined(series: Series) -> float:
    """The largest magnitude, by the parabola through the largest sample and its neighbours."""
    return top(magnitude(series))[0]


def unresolved(series: Series) -> float:
    """Possible error of a largest magnitude that may lie between samples."""
    sizes = magnitude(series)
    largest, refined = value(series), top(sizes)[0]
    signs = (above(one, largest, refined) for one in (series, negative(series)))
    return max(isolated(sizes), *signs)
