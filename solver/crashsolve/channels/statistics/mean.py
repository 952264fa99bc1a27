"""Mean over time.

mean = (integral of x dt) / (t_end - t_0),   trapezoidal rule between samples
"""

from crashsolve.channels.series import Series
from crashsolve.channels.statistics import integral


def value(series: Series) -> float:
    """The mean over time by trapezoids."""
    return _over_time(series, integral.value(series))


def refined(series: Series) -> float:
    """The mean over time by Simpson's rule."""
    return _over_time(series, integral.refined(series))


def _over_time(series: Series, area: float) -> float:
    span = float(series.time[-1] - series.time[0])
    return area / span if span > 0 else float(series.values[0])
