"""Upper envelope: the greatest value within a duration around each moment.

    env(t) = max of x from t - duration / 2 to t + duration / 2

of straight lines between the samples, and of what the history has of that time at its ends. The
lower envelope is -envelope(-x, ...); choose a duration longer than a period of the vibration.
"""

import numpy as np

from crashsolve.channels.functions._spans import Spans
from crashsolve.channels.term import Term, duration

SAMPLED = True


def apply(time: np.ndarray, x: Term, length: Term) -> Term:
    """The envelope, in the unit of x; raises ChannelError for no duration."""
    half, values = 0.5 * duration(length, "envelope"), x.over(time)
    begin, end = np.maximum(time - half, time[0]), np.minimum(time + half, time[-1])
    first = np.searchsorted(time, begin)
    last = np.searchsorted(time, end, side="right") - 1
    upper = Spans(values).greatest(first, last)
    for moments in (begin, end):
        upper = np.maximum(upper, np.interp(moments, time, values))
    return Term(upper, x.unit)
