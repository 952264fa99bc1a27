"""Extremes of positions, lengths and angles between samples, by their rates at the samples.

    x(s) = (1 + 2 s) (1 - s)^2 x_0 + (3 - 2 s) s^2 x_1 + h s (1 - s) ((1 - s) v_0 - s v_1)

The cubic with the values and rates at both ends of an interval of h. A vibration with two samples a
period may show nothing of itself in its positions, and then all of it in its velocities. Where
samples resolve a motion the cubics have the tops of the parabolas by the samples. Consequence to
test: a sine sampled at its zeros has an error of a third of its amplitude and more.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from crashsolve.channels.series import Series, within
from crashsolve.channels.statistic import refined
from crashsolve.channels.statistics._top import magnitude, negative
from crashsolve.estimate.error import Estimate
from crashsolve.recording.samples import Channel, read

# quantities of a family and their rates
RATES = {"position": "velocity", "length": "rate", "angle": "rate", "travel": "rate"}
EXTREMES = ("max", "min", "abs_max")
# positions in an interval: a top between two of them is missed by a hundredth of its rise
SHARES = np.linspace(0.0, 1.0, 11)[1:-1, None]


def with_rates(
    estimates: Sequence[Estimate], channels: Mapping[str, list[Channel]], history: Path
) -> list[Estimate]:
    """Estimates of extremes, with what rates show between samples; `channels` by expression."""
    return [_with_rate(e, channels[e.watch.channels[0]], history) for e in estimates]


def _with_rate(estimate: Estimate, channels: Sequence[Channel], history: Path) -> Estimate:
    watch, (channel, *others) = estimate.watch, channels
    if estimate.error is None or watch.statistic not in EXTREMES or others:
        return estimate
    rate = rate_of(channel) if watch.channels[0].strip() == channel.name else None
    if rate is None or not _is_written(rate, history):
        return estimate
    samples = read(history, [channel, rate])
    x, v = (within(samples.series(one.name), watch.during) for one in (channel, rate))
    missed = rise(x, v.values, watch.statistic)
    if missed <= estimate.error:
        return estimate
    how = f"{estimate.how}; by {rate.name} between samples {missed:.2g} {estimate.unit}"
    return replace(estimate, error=missed, how=how.rstrip())


def rate_of(channel: Channel) -> Channel | None:
    """The channel of the rate of a position, length or angle; None for others."""
    columns = channel.family.columns
    own = columns[channel.column]
    for i, column in enumerate(columns):
        if column.quantity == RATES.get(own.quantity) and column.component == own.component:
            name = channel.family.channel(channel.entity, i)
            return channel._replace(name=name, column=i)
    return None


def _is_written(channel: Channel, history: Path) -> bool:
    import h5py

    column = channel.family.columns[channel.column]
    with h5py.File(history) as file:
        return f"{channel.family.name}/{column.path}" in file


def rise(x: Series, v: np.ndarray, statistic: str) -> float:
    """How far an extreme of the cubics is beyond that of the parabolas by samples; `v` are the
    rates of `x` (n,).
    """
    if statistic == "min":
        x, v = negative(x), -v
    h, values, s = np.diff(x.time), x.values, SHARES
    cubics = (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * values[:-1]
        + (3.0 - 2.0 * s) * s**2 * values[1:]
        + h * s * (1.0 - s) * ((1.0 - s) * v[:-1] - s * v[1:])
    )
    if statistic == "abs_max":
        x, cubics = magnitude(x), np.abs(cubics)
    return float(np.max(cubics, initial=-np.inf)) - refined(x, "max")
