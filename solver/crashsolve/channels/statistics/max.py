"""Largest sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import isolated, top

unresolved = isolated


def value(series: Series) -> float:
    """Of the samples."""
    return float(np.max(series.values))


def refined(series: Series) -> float:
    """Of the parabola through the greatest sample and its neighbours."""
    return top(series)[0]
