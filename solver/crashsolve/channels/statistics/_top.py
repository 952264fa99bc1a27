"""The greatest value of a history, and its time, seen between the samples.

The top of the parabola through the greatest sample and its two neighbours. Where a history stays at
its extreme for three samples to the last digit, it has jumped there, as a count does: no parabola,
and the time is known to one sample.
"""

import numpy as np

from crashsolve.channels.series import Series

# a sample that stands out by more than this share of the range stands alone
SINGLE = 0.3


def negative(series: Series) -> Series:
    """The history with its sign changed."""
    return series._replace(values=-series.values)


def magnitude(series: Series) -> Series:
    """The absolute values of a history."""
    return series._replace(values=np.abs(series.values))


def top(series: Series) -> tuple[float, float]:
    """Value and time [s] at the top of the parabola by the greatest sample and its neighbours."""
    time, values = series.time, series.values
    at = int(np.argmax(values))
    if not 0 < at < len(values) - 1 or plateau(values, at) > at + 1:
        return float(values[at]), float(time[at])
    left, right = time[at - 1] - time[at], time[at + 1] - time[at]
    low, high = values[at - 1] - values[at], values[at + 1] - values[at]
    # the parabola b x + c x^2 about the greatest sample
    c = (high / right - low / left) / (right - left)
    b = low / left - c * left
    if not c < 0.0:
        return float(values[at]), float(time[at])
    x = -b / (2.0 * c)
    return float(values[at] + 0.5 * b * x), float(time[at] + x)


def plateau(values: np.ndarray, at: int) -> int:
    """Last of the samples from `at` on that are equal to the last digit."""
    after = np.flatnonzero(values[at:] != values[at])
    return at + int(after[0]) - 1 if len(after) else len(values) - 1


def isolated(series: Series) -> float:
    """Possible error of a largest value that one sample alone shows; else 0."""
    values = series.values
    at = int(np.argmax(values))
    if not 0 < at < len(values) - 1:
        return 0.0
    drop = float(values[at] - max(values[at - 1], values[at + 1]))
    # a parabola through three such samples means nothing
    return drop if drop > SINGLE * float(np.ptp(values)) else 0.0


def jumped(series: Series) -> float:
    """Time [s] by which the moment of the greatest value is unknown when it was jumped to."""
    at = int(np.argmax(series.values))
    is_jump = at > 0 and plateau(series.values, at) > at + 1
    return float(series.time[at] - series.time[at - 1]) if is_jump else 0.0
