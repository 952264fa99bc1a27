"""Time of the first largest sample."""

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import greatest, jumped, top

IS_A_TIME = True
unresolved = jumped


def value(series: Series) -> float:
    """The time [s] of the largest sample."""
    return float(series.time[greatest(series.values)])


def refined(series: Series) -> float:
    """Time [s] of the maximum of the parabola through the largest sample and its neighbours."""
    return top(series)[1]


def unit(unit: str) -> str:
    """The unit of times."""
    return "s"
