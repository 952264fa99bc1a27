"""Value at the time T [s]: of the sample there, else of the straight line between two samples.

A run samples the times that its deck asks for. Between samples the line may be wrong by more than
any number of samples can show, for instance across an impact: the remark states it.
"""

import numpy as np

from crashsolve.channels.errors import ChannelError
from crashsolve.channels.series import SAME, Series

ARGUMENT = "T"
IS_OF_A_MOMENT = True


def value(series: Series, moment: float) -> float:
    """The value of the last sample at exactly that time, else linear between two; raises
    ChannelError.
    """
    time, values, _ = series
    after = _after(series, moment)
    if time[after - 1] == moment:
        return float(values[after - 1])
    share = (moment - time[after - 1]) / (time[after] - time[after - 1])
    return float(values[after - 1] + share * (values[after] - values[after - 1]))


def refined(series: Series, moment: float) -> float:
    """The value of the cubic through the four nearest samples."""
    time, values, _ = series
    after = _after(series, moment)
    if time[after - 1] == moment:
        return float(values[after - 1])
    first = min(max(after - 2, 0), max(len(time) - 4, 0))
    x, y = time[first : first + 4], values[first : first + 4]
    weights = [
        np.prod([(moment - other) / (own - other) for other in x if other != own]) for own in x
    ]
    interpolated = float(np.dot(weights, y))
    # some of the four may have no value
    return interpolated if np.isfinite(interpolated) else value(series, moment)


def remark(series: Series, moment: float) -> str:
    """Note on the samples between which a value is interpolated, and its error; "" at a sample."""
    after = _after(series, moment)
    if after == len(series.time):
        return ""
    (begin, end), (low, high) = series.time[after - 1 : after + 1], series.values[after - 1 :][:2]
    if min(moment - begin, end - moment) <= SAME * (end - begin):
        return ""
    bend = abs(refined(series, moment) - value(series, moment))
    return (
        f"no sample at {moment:.9g} s: interpolated from {low:.6g} at {begin:.9g} s to "
        f"{high:.6g} at {end:.9g} s; its error is about {bend:.1g} where the history is smooth, up "
        f"to {abs(high - low):.1g} or more where it jumps. A deck that watches at:{moment:.9g} of "
        "the channel has a sample there"
    )


def _after(series: Series, moment: float) -> int:
    """Number of the first sample after a time; raises ChannelError for one outside the samples."""
    time = series.time
    if not time[0] <= moment <= time[-1]:
        raise ChannelError(f"at:{moment:g} is outside the samples, {time[0]:g} s to {time[-1]:g} s")
    return int(np.searchsorted(time, moment, side="right"))
