"""The greatest value of a history, and its time, seen between the samples.

The top of the parabola through the greatest sample and its two neighbours. Where the history runs
straight on both sides, as an acceleration that follows a table, it is the corner at which the two
lines meet. Where a history stays at its extreme for three samples but for round-off, it has jumped
there, as a count does: no parabola, and the time is known to one sample.
"""

import numpy as np

from crashsolve.channels.series import Series

# a sample that stands out by more than this share of the range stands alone
SINGLE = 0.3
# of the change of slope at a corner: a smooth top, whose slope changes evenly, has a third on each
# side
STRAIGHT = 0.1
ROUND_OFF = 1e-9
# of the range: round-off of an acceleration that is constant
EQUAL = 1e-11
# of the rise of a parabola over its largest sample: what it may miss of the top
PARABOLA = 0.1


def negative(series: Series) -> Series:
    """The history with its sign changed."""
    return series._replace(values=-series.values)


def magnitude(series: Series) -> Series:
    """The absolute values of a history."""
    return series._replace(values=np.abs(series.values))


def top(series: Series) -> tuple[float, float]:
    """Value and time [s] at the top: of the parabola by the greatest sample and its neighbours, or
    of the corner at which two straight sides meet.
    """
    time, values = series.time, series.values
    at = greatest(values)
    plain = float(values[at]), float(time[at])
    if len(values) < 3 or plateau(values, at) > at + 1:
        return plain
    meeting = corner(series, at) or corner(series, at - 1)
    if meeting is not None:
        return meeting
    # beside the first or last sample it is that through the three next to it
    middle = min(max(at, 1), len(values) - 2)
    left, right = time[middle - 1] - time[middle], time[middle + 1] - time[middle]
    low, high = values[middle - 1] - values[middle], values[middle + 1] - values[middle]
    # the parabola b x + c x^2 about the middle sample
    c = (high / right - low / left) / (right - left)
    b = low / left - c * left
    if not c < 0.0:
        return plain
    x = -b / (2.0 * c)
    if not left < x < right:
        return plain
    return float(values[middle] + 0.5 * b * x), float(time[middle] + x)


def heights(series: Series) -> np.ndarray:
    """What each sample may be the top of (n,): a local maximum that of its parabola, and a tenth of
    the rise to it more.
    """
    time, values = series.time, series.values
    tops = values.copy()
    if len(values) < 3:
        return tops
    left, right = time[:-2] - time[1:-1], time[2:] - time[1:-1]
    low, high = values[:-2] - values[1:-1], values[2:] - values[1:-1]
    c = (high / right - low / left) / (right - left)
    b = low / left - c * left
    is_top = (low <= 0.0) & (high <= 0.0) & (c < 0.0)
    tops[1:-1][is_top] += (1.0 + PARABOLA) * b[is_top] ** 2 / (-4.0 * c[is_top])
    return tops


def corner(series: Series, at: int) -> tuple[float, float] | None:
    """Value and time [s] where straight lines, up to sample `at` and from the next one on, meet.

    None where they do not meet between these samples, or where the history is not straight there.
    """
    if not 2 <= at <= len(series.time) - 4:
        return None
    time, values = series.time[at - 2 : at + 4], series.values[at - 2 : at + 4]
    before, rise, _, fall, after = np.diff(values) / np.diff(time)
    change = rise - fall
    if max(abs(rise - before), abs(after - fall)) > STRAIGHT * change or not rise > 0.0 > fall:
        return None
    span = time[3] - time[2]
    x = (values[3] - values[2] - fall * span) / change
    # a corner at a sample, to the last digits
    is_between = -ROUND_OFF * span <= x <= (1.0 + ROUND_OFF) * span
    return (float(values[2] + rise * x), float(time[2] + x)) if is_between else None


def greatest(values: np.ndarray) -> int:
    """First of the samples that are the greatest but for round-off."""
    return int(np.argmax(values >= np.max(values) - EQUAL * np.ptp(values)))


def plateau(values: np.ndarray, at: int) -> int:
    """Last of the samples from `at` on that are equal but for round-off."""
    after = np.flatnonzero(np.abs(values[at:] - values[at]) > EQUAL * np.ptp(values))
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
    at = greatest(series.values)
    is_jump = at > 0 and plateau(series.values, at) > at + 1
    return float(series.time[at] - series.time[at - 1]) if is_jump else 0.0
