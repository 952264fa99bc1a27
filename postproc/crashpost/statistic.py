"""One number from a time history.

    mean = (integral of x dt) / (t_end - t_0),   trapezoidal rule between samples

argmax and argmin give the time of the first largest and smallest sample. A time window leaves the
samples within it, its ends included; mean and integral run from the first of them to the last.
"""

import math

import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.expression import Series, cumulative

STATISTICS = ("max", "min", "abs_max", "mean", "final", "integral", "argmax", "argmin", "at:T")
TIMES = ("argmax", "argmin")
Window = tuple[float, float]


def statistic(series: Series, word: str, during: Window | None = None) -> float:
    """The number called `word` of a series, or of its part in a time window; raises PostError."""
    if during and (word == "final" or word.startswith("at:")):
        raise PostError(f"'{word}' reads one moment, which no time window limits")
    time, values, _ = within(series, during) if during else series
    if not len(values):
        raise PostError("the channel holds no samples yet")
    if word.startswith("at:"):
        return _defined(_at(series, word[3:]))
    if word == "final":
        return _defined(float(values[-1]))
    undefined = np.flatnonzero(np.isnan(values))
    if len(undefined):
        raise PostError(
            f"division by zero at t = {time[undefined[0]]:g} s; ask for a time window without it"
        )
    match word:
        case "max":
            return float(np.max(values))
        case "min":
            return float(np.min(values))
        case "abs_max":
            return float(np.max(np.abs(values)))
        case "integral":
            return float(cumulative(time, values)[-1])
        case "mean":
            return _mean(time, values)
        case "argmax":
            return float(time[np.argmax(values)])
        case "argmin":
            return float(time[np.argmin(values)])
    raise unknown("statistic", word, STATISTICS)


def _defined(value: float) -> float:
    if math.isnan(value):
        raise PostError("division by zero at that time")
    return value


def unit_of(word: str, unit: str) -> str:
    """The unit of a statistic of a channel that has `unit`."""
    if word in TIMES:
        return "s"
    return f"{unit} s".strip() if word == "integral" else unit


def within(series: Series, window: Window) -> Series:
    """The samples of a closed time window; PostError when it holds none or leaves the run."""
    time, name = series.time, f"{window[0]:g} s to {window[1]:g} s"
    if len(time) and not (time[0] <= window[0] and window[1] <= time[-1]):
        raise PostError(f"{name} is outside the samples, {time[0]:g} s to {time[-1]:g} s")
    inside = (time >= window[0]) & (time <= window[1])
    if not inside.any():
        raise PostError(f"no sample from {name}")
    return Series(time[inside], series.values[inside], series.unit)


def _mean(time: np.ndarray, values: np.ndarray) -> float:
    span = time[-1] - time[0]
    return float(cumulative(time, values)[-1] / span) if span > 0 else float(np.mean(values))


def _at(series: Series, text: str) -> float:
    """The value at a time: of the last sample at exactly that time, else linear between two."""
    time, values, _ = series
    try:
        moment = float(text)
    except ValueError:
        moment = math.nan
    if not math.isfinite(moment):
        raise PostError(f"'at:{text}' is not a time; write for instance at:0.25 (seconds)")
    if not time[0] <= moment <= time[-1]:
        raise PostError(f"at:{text} is outside the samples, {time[0]:g} s to {time[-1]:g} s")
    after = int(np.searchsorted(time, moment, side="right"))
    if time[after - 1] == moment:
        return float(values[after - 1])
    share = (moment - time[after - 1]) / (time[after] - time[after - 1])
    return float(values[after - 1] + share * (values[after] - values[after - 1]))
