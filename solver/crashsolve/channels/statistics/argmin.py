"""Time of the first smallest sample."""

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import greatest, jumped, negative, top

IS_A_TIME = True


def value(series: Series) -> float:
    """The time [s] of the smallest sample."""
    return float(series.time[greatest(-series.values)])


def refined(series: Series) -> float:
    """Time [s] of the minimum of the parabola through the smallest sample and its neighbours."""
    return top(negative(series))[1]


def unresolved(series: Series) -> float:
    """The sampling interval before a jump of the minimum [s]."""
    return jumped(negative(series))


def unit(unit: str) -> str:
    """The unit of times."""
    return "s"
