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


class Criterion(NamedTuple):
    """The criterion of the history up to each sample (n,), and its window [s]."""

    value: np.ndarray
    start: np.ndarray
    end: np.ndarray


def criterion(time: np.ndarray, a: Term, window: Term | None, function: str) -> Criterion:
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
    integral = cumulative(time, size)
    zero, first = np.zeros(len(time)), np.full(len(time), time[0])
    best = Criterion(zero, first, first.copy())
    for lag in range(1, len(time)):
        last = np.flatnonzero(time[lag:] - time[:-lag] <= length * (1.0 + SAME)) + lag
        if not len(last):
            break
        _keep_larger(
            best, last, time[last - lag], time[last], integral[last] - integral[last - lag]
        )
    if np.isfinite(length):
        for begin in _full_windows(time, length):
            end = begin + length
            integrals = _integral(time, size, integral, end) - _integral(
                time, size, integral, begin
            )
            # of several that end before one sample the largest comes last
            order = np.argsort(integrals, kind="stable")
            last = np.minimum(np.searchsorted(time, end - SAME * length), len(time) - 1)
            _keep_larger(best, last[order], begin[order], end[order], integrals[order])
    return _running_maximum(best)


def _keep_larger(
    criterion: Criterion, last: np.ndarray, begin: np.ndarray, end: np.ndarray, integral: np.ndarray
) -> None:
    """Enter windows that end by the samples `last`, where they are larger. Writes: criterion."""
    value = (end - begin) * (integral / (end - begin)) ** EXPONENT
    is_larger = value > criterion.value[last]
    for column, new in zip(criterion, (value, begin, end), strict=True):
        column[last[is_larger]] = new[is_larger]


def _full_windows(time: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Starts [s] of the windows of full length that begin, and that end, at a sample."""
    return time[time + length <= time[-1]], time[time - length >= time[0]] - length


def _integral(
    time: np.ndarray, size: np.ndarray, integral: np.ndarray, moments: np.ndarray
) -> np.ndarray:
    """Integral from the first sample to any moment, of straight lines between the samples."""
    before = np.clip(np.searchsorted(time, moments, side="right") - 1, 0, len(time) - 2)
    past, step = moments - time[before], time[before + 1] - time[before]
    slope = (size[before + 1] - size[before]) / step
    areas: np.ndarray = integral[before] + past * (size[before] + 0.5 * slope * past)
    return areas


def _running_maximum(windows: Criterion) -> Criterion:
    """The largest of all windows that end until each sample, and the first of equal ones."""
    largest = np.maximum.accumulate(windows.value)
    is_new = np.concatenate(([True], largest[1:] > largest[:-1]))
    first = np.maximum.accumulate(np.where(is_new, np.arange(len(largest)), 0))
    return Criterion(largest, windows.start[first], windows.end[first])
