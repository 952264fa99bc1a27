"""Clip: the greatest level that is kept without a break for a duration, up to each moment.

    clip = max over s of  min of x from s to s + duration

as the "3 ms clip" of SAE J1727 is defined, exact for straight lines between the samples, and of
second order in their interval for the filtered signal. It counts one unbroken span; limits of
regulations that add up several, as FMVSS 208 does for the thorax, may be higher. Until a duration
has passed it is the level of the first span, so that no value that was not kept is its maximum.

References: SAE J1727 (2015).
"""

import numpy as np

from crashsolve.channels.errors import TooShort
from crashsolve.channels.functions._spans import Spans
from crashsolve.channels.term import Term, duration

SAMPLED = True


def apply(time: np.ndarray, x: Term, length: Term) -> Term:
    """The level so far, in the unit of x; raises ChannelError for a run that is shorter."""
    span, values = duration(length, "clip"), np.array(x.over(time))
    if not time[-1] - time[0] >= span:
        raise TooShort(f"clip() needs a history of {1e3 * span:g} ms or more")
    starts = np.union1d(time, time - span)
    starts = starts[(starts >= time[0]) & (starts <= time[-1] - span)]
    inner, ends = Spans(-values), starts + span

    def inside(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Least of the samples within."""
        first = np.searchsorted(time, begin)
        return -inner.greatest(first, np.searchsorted(time, end, side="right") - 1)

    left, right = np.interp(starts, time, values), np.interp(ends, time, values)
    levels_at_ends = [(ends, np.minimum(np.minimum(left, right), inside(starts, ends)))]
    # between two starts both ends run along straight lines, and are equal at most once
    apart = left - right
    crosses = np.flatnonzero(apart[:-1] * apart[1:] < 0.0)
    if len(crosses):
        share = apart[crosses] / (apart[crosses] - apart[crosses + 1])
        begin = starts[crosses] + share * (starts[crosses + 1] - starts[crosses])
        level = left[crosses] + share * (left[crosses + 1] - left[crosses])
        levels_at_ends.append((begin + span, np.minimum(level, inside(begin, begin + span))))
    return Term(_running_maximum(time, levels_at_ends), x.unit)


def _running_maximum(
    time: np.ndarray, levels_at_ends: list[tuple[np.ndarray, np.ndarray]]
) -> np.ndarray:
    """The greatest level of spans that have ended until each sample; before, that of the first."""
    ends, levels = (np.concatenate(column) for column in zip(*levels_at_ends, strict=True))
    order = np.argsort(ends)
    greatest = np.maximum.accumulate(levels[order])
    # the last span ends with the run, in spite of round-off
    ended = np.searchsorted(np.minimum(ends[order], time[-1]), time, side="right")
    return greatest[np.maximum(ended, 1) - 1]
