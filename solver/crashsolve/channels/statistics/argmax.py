"""Time of the first largest sample."""

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import jumped, top

IS_A_TIME = True
unresolved = jumped


def value(series: Series) -> float:
    """Of the samples."""
    return float(series.time[np.argmax(series.values)])


def refined(series: Series) -> float:
    """Of the parabola through the greatest sample and its neighbours."""
    return top(series)[1]


def unit(unit: str) -> str:
    """That of times."""
    return "s"
