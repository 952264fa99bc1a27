"""The window of the Head Injury Criterion.

    HIC = max over t1 < t2 <= t1 + w of  (t2 - t1) (A / (t2 - t1))^2.5,   A = integral from t1 to t2
          of a dt

a is the magnitude in g, the integral that of straight lines between the samples. Windows begin and
end at samples; those of full length w also begin or end between two. As the criterion is stationary
in a free window, the error by this is of second order in the interval, as is the quadrature.

References: NHTSA, FMVSS 208 (49 CFR 571.208); SAE J885 (2011).
"""

from typing import NamedTuple

import numpy as np

from crashsolve.channels.errors import ChannelError, TooShort
from crashsolve.channels.series import SAME, cumulative
from crashsolve.channels.term import Term, duration, in_gravities

EXPONENT = 2.5
# windows that are evaluated: some ten seconds of work
MAX_WINDOWS = 1_000_000_000


class Worst(NamedTuple):
    """The criterion of the history up to each sample (n,), and its window [s]."""

    value: np.ndarray
    start: np.ndarray
    end: np.ndarray


def worst(time: np.ndarray, a: Term, window: Term | None, function: str) -> Worst:
    """The criterion up to each sample; raises ChannelError, TooShort for less than two samples."""
    if len(time) < 2:
        raise TooShort(f"{function}() needs two samples or more, not {len(time)}")
    size = in_gravities(a, time, function)
    length = np.inf if window is None else duration(window, function)
    if np.isnan(size).any():
        raise ChannelError(f"division by zero within {function}()")
    if len(time) * np.searchsorted(time, time[0] + length) > MAX_WINDOWS:
        advice = "give a shorter window, or a longer output.history.interval"
        raise ChannelError(f"{function}() of {len(time)} samples has too many windows: {advice}")
    gained = cumulative(time, size)
    zero, first = np.zeros(len(time)), np.full(len(time), time[0])
    found = Worst(zero, first, first.copy())
    for lag in range(1, len(time)):
        last = np.flatnonzero(time[lag:] - time[:-lag] <= length * (1.0 + SAME)) + lag
        if not len(last):
            break
        _take(found, last, time[last - lag], time[last], gained[last] - gained[last - lag])
    if np.isfinite(length):
        for begin in _full_windows(time, length):
            end = begin + length
            more = _integral(time, size, gained, end) - _integral(time, size, gained, begin)
            # of several that end before one sample the worst is taken last
            order = np.argsort(more, kind="stable")
            last = np.minimum(np.searchsorted(time, end - SAME * length), len(time) - 1)
            _take(found, last[order], begin[order], end[order], more[order])
    return _so_far(found)


def _take(
    found: Worst, last: np.ndarray, begin: np.ndarray, end: np.ndarray, gained: np.ndarray
) -> None:
    """Windows that are known from the samples `last` on, where they are worse. Writes: found."""
    value = (end - begin) * (gained / (end - begin)) ** EXPONENT
    worse = value > found.value[last]
    for column, new in zip(found, (value, begin, end), strict=True):
        column[last[worse]] = new[worse]


def _full_windows(time: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Starts [s] of the windows of full length that begin, and that end, at a sample."""
    return time[time + length <= time[-1]], time[time - length >= time[0]] - length


def _integral(
    time: np.ndarray, size: np.ndarray, gained: np.ndarray, moments: np.ndarray
) -> np.ndarray:
    """Integral from the first sample to any moment, of straight lines between the samples."""
    before = np.clip(np.searchsorted(time, moments, side="right") - 1, 0, len(time) - 2)
    past, step = moments - time[before], time[before + 1] - time[before]
    slope = (size[before + 1] - size[before]) / step
    found: np.ndarray = gained[before] + past * (size[before] + 0.5 * slope * past)
    return found


def _so_far(found: Worst) -> Worst:
    """The worst of all windows that end until each sample, and the first that is so bad."""
    greatest = np.maximum.accumulate(found.value)
    is_new = np.concatenate(([True], greatest[1:] > greatest[:-1]))
    holder = np.maximum.accumulate(np.where(is_new, np.arange(len(greatest)), 0))
    return Worst(greatest, found.start[holder], found.end[holder])
