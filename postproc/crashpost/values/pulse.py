"""A crash pulse in a few numbers: velocity change, stroke and occupant load criterion.

The occupant load criterion is the constant deceleration of an occupant who flies on freely for
65 mm relative to the vehicle, and whom a belt brings to the velocity of the vehicle within 300 mm
(Kuebler, Gargallo, Elsaesser 2009: Bewertungskriterien zur Auslegung von Insassenschutzsystemen).
"""

import numpy as np

from crashpost.errors import PostError
from crashpost.results.choice import plain
from crashpost.results.result import Result
from crashpost.values.injury_measure import Measure

FREE, RESTRAINED = 0.065, 0.235  # [m]


def pulse_measures(result: Result, sensor: str, name: str) -> list[Measure]:
    """Measures of the axis whose velocity changes most; `name` is the sensor's, in words."""
    time, velocity = None, np.empty(0)
    for axis in "xyz":
        series = result.series(plain(f"nodout.{sensor}.velocity.{axis}"))
        change = series.values - series.values[0]
        if time is None or np.abs(change).max() > np.abs(velocity).max():
            time, velocity, along = series.time, change, axis
    if time is None or len(time) < 3:
        return []
    slowing = -velocity * np.sign(velocity[np.abs(velocity).argmax()])
    at = int(np.argmin(slowing))
    gap, when = -travel(time, slowing), (float(time[at]),)
    change, stroke = float(-slowing[at]), float(gap[at])
    measured = [
        Measure(name, f"velocity change along {along}", change, "m/s", "at {}", times=when),
        Measure(name, "stroke of a free occupant", stroke, "m", "until {}", times=when),
    ]
    try:
        value, *span = load_criterion(time, slowing)
    except PostError as reason:
        return [*measured, Measure(name, "OLC", None, "m/s^2", str(reason))]
    return [*measured, Measure(name, "OLC", value, "m/s^2", "{} to {}", times=tuple(span))]


def travel(time: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Integral (n,) of a velocity by trapezoids [m]."""
    steps = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time)
    return np.concatenate([[0.0], np.cumsum(steps)])


def load_criterion(time: np.ndarray, slowing: np.ndarray) -> tuple[float, float, float]:
    """OLC [m/s^2], begin and end of the belt's hold [s]; `slowing` is v - v0, below 0.

    Raises PostError where the occupant does not come so far.
    """
    gap = -travel(time, slowing)
    start = _crossing(time, gap - FREE, "moves freely by 65 mm")
    # with a belt: s = integral of -(v - v0) - a (t - t1)^2 / 2, equal velocities at the end
    after = time > start
    t = time[after] - start
    pull = -slowing[after] / t
    rest = gap[after] - 0.5 * pull * t**2 - (FREE + RESTRAINED)
    end = _crossing(time[after], rest, "is stopped within 300 mm")
    return float(-np.interp(end, time, slowing) / (end - start)), start, end


def _crossing(time: np.ndarray, values: np.ndarray, what: str) -> float:
    """First time at which values pass zero upwards, by chords."""
    above = np.flatnonzero(values >= 0.0)
    if not len(above):
        raise PostError(f"before the end of the run no occupant {what}")
    k = int(above[0])
    if k == 0:
        return float(time[0])
    share = -values[k - 1] / (values[k] - values[k - 1])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))
