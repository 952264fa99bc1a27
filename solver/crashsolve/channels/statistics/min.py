"""Smallest sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import between, negative, top


def value(series: Series) -> float:
    """The smallest of the samples."""
    return float(np.min(series.values))


def refined(series: Series) -> float:
    """The minimum of the parabola through the smallest sample and its neighbours."""
    return -top(negative(series))[0]


def unresolved(series: Series) -> float:
    """Possible error of a smallest value that one sample alone shows."""
    return between(negative(series))
