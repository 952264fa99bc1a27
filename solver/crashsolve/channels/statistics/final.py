"""Last sample."""

from crashsolve.channels.series import Series

IS_OF_A_MOMENT = True


def value(series: Series) -> float:
    """The value of the last sample."""
    return float(series.values[-1])
