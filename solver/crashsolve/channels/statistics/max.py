"""Largest sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import between, top

unresolved = between


def value(series: Series) -> float:
    """The largest of the samples."""
    return float(np.max(series.values))


def refined(series: Series) -> float:
    """The maximum of the parabola through the largest sample and its neighbours."""
    return top(series)[0]
