"""A time history with its basic operations: windows and the trapezoidal rule."""

from typing import NamedTuple

import numpy as np

from crashsolve.channels.errors import ChannelError

Window = tuple[float, float]
# [of the interval] a time this near to a sample is that sample
SAME = 1e-9


class Series(NamedTuple):
    """One time history: sample times [s] and values, both (n,), and the unit of the values."""

    time: np.ndarray
    values: np.ndarray
    unit: str = ""


def within(series: Series, window: Window | None) -> Series:
    """The samples of a closed time window [s]. Raises ChannelError when it holds none."""
    if window is None:
        return series
    inside = (series.time >= window[0]) & (series.time <= window[1])
    if not inside.any():
        raise ChannelError(f"no sample from {window[0]:g} s to {window[1]:g} s")
    return Series(series.time[inside], series.values[inside], series.unit)


def covered(series: Series, window: Window | None) -> Series:
    """The samples of a closed time window [s] that they cover.

    Raises ChannelError for one that leaves the run.
    """
    if window is not None and len(series.time):
        first, last = series.time[0], series.time[-1]
        if not (first <= window[0] and window[1] <= last):
            name = f"{window[0]:g} s to {window[1]:g} s"
            raise ChannelError(f"{name} is outside the samples, {first:g} s to {last:g} s")
    return within(series, window)


def cumulative(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Integral (n,) from the first sample to each sample by the trapezoidal rule."""
    areas = np.diff(time) * (values[1:] + values[:-1]) / 2
    return np.concatenate(([0.0], np.cumsum(areas)))
