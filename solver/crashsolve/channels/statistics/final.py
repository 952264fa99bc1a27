"""Last sample."""

from crashsolve.channels.series import Series

IS_OF_A_MOMENT = True


def value(series: Series) -> float:
    """Of the samples."""
    return float(series.values[-1])
