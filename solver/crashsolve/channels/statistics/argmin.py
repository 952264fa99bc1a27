"""Time of the first smallest sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import jumped, negative, top

IS_A_TIME = True


def value(series: Series) -> float:
    """Of the samples."""
    return float(series.time[np.argmin(series.values)])


def refined(series: Series) -> float:
    """Of the parabola through the least sample and its neighbours."""
    return top(negative(series))[1]


def unresolved(series: Series) -> float:
    """Where it jumped, the interval before."""
    return jumped(negative(series))


def unit(unit: str) -> str:
    """That of times."""
    return "s"
