"""Rigid bodies whose motion between two samples is not that of the samples.

    h = |dv - (a_0 + a_1) dt / 2| / dt    of velocities and accelerations, of both translation and
    rotation, and of positions and velocities, beyond

    SPREAD x (range of a over four samples) + SHARE x (largest |a| of them) + ROUND_OFF / dt

A stop, a spring with a gap or a belt may catch a body and release it within one interval, and a
vibration may have a whole number of periods in it. Where samples resolve a motion, h is the error
of the trapezoidal rule; where a force begins within an interval it is half the range of a at most.
An interval of one step hides nothing: what differs there is the error of the step.
Consequence to test: a rebound between two samples is reported, a vibration with three samples a
half wave is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import h5py

    from crashsolve.deck.reading.deck import Deck
    from crashsolve.model.phases import Phase
    from crashsolve.system.engine import Engine

SPREAD, SHARE = 0.5, 0.02
# of the largest position and velocity, that of rotations over the size of the model at least:
# round-off, and what dense output of a tolerance of 1e-6 adds
ROUND_OFF, RATE_ROUND_OFF = 1e-9, 1e-5
# of the size of the model: what a body moves within an interval while it is at rest
REST = 1e-10
# samples that are read at once, times bodies
PIECE = 1 << 13
# a motion and its rate, and the errors of the former
RATES = (
    ("velocity", "acceleration", RATE_ROUND_OFF),
    ("angular_velocity", "angular_acceleration", RATE_ROUND_OFF),
    ("position", "velocity", ROUND_OFF),
)
MOTIONS = tuple(dict.fromkeys(word for one in RATES for word in one[:2]))
ORDER = {rate: k for k, (_, rate, _) in enumerate(RATES)}
UNITS = {
    "acceleration": "m/s^2",
    "angular_acceleration": "rad/s^2",
    "velocity": "m/s",
}


@dataclass(frozen=True)
class MissedMotion:
    """A body, and the interval of samples that hides most of its motion."""

    name: str
    start: float  # [s]
    end: float  # [s]
    rate: str  # the channel that does not show it
    hidden: float  # mean of it over the interval that the samples do not show [SI]

    @property
    def displacement(self) -> float:
        """What the samples may miss of a position or an angle [m or rad]: a velocity that reverses
        in the middle of the interval misses a quarter of its change times the interval.
        """
        span = self.end - self.start
        return self.hidden * span * (1.0 if self.rate == "velocity" else 0.25 * span)

    def words(self) -> str:
        """The warning of it."""
        return (
            f"body '{self.name}': its {self.rate.replace('_', ' ')} between the samples at "
            f"{self.start:.6g} and {self.end:.6g} s has a mean that differs by {self.hidden:.4g} "
            f"{UNITS[self.rate]} from what they show: largest values and integrals of forces and "
            "motions, HIC and filters miss it; give a shorter output.history.interval"
        )


def missed_motions(engine: Engine, history: Path, deck: Deck) -> list[MissedMotion]:
    """Bodies whose motion the samples of a finished run miss, each with its worst interval.

    None in equilibria, and in phases that stop bodies to find one.
    """
    import h5py

    worst: dict[str, MissedMotion] = {}
    begin = _begin_of_motion(engine.model.phases)
    if deck.control.solution != "transient" or begin == inf:
        return []
    with h5py.File(history) as file:
        if "rbdout" not in file:
            return []
        names = list(file["rbdout"]["ids"].asstr())
        bodies = [k for k, name in enumerate(names) if name in deck.entries["bodies"]]
        if not bodies:
            return []
        # a run whose errors are estimated writes all of them (recording/selection.py)
        words = [word for word in MOTIONS if _is_whole(file["rbdout"], word)]
        rates = [one for one in RATES if {*one[:2]} <= {*words}]
        cycles = file["glstat"]["cycle"][:, 0]
        for rows, time, of in _pieces(file["rbdout"], words, bodies):
            # samples at the ends of one step miss nothing of it
            shows_all = (np.diff(cycles[rows]) <= 1.0) | (time[:-1] <= begin)
            for motion, rate, round_off in rates:
                x, v = of[motion], of[rate]
                least = 0.0
                if motion == "angular_velocity" and "velocity" in of:
                    least = _largest(of["velocity"]) / engine.model.size
                noise = round_off * max(_largest(x), least)
                hidden, tolerance = _hidden(time, x, v, noise, REST * engine.model.size)
                hidden[shows_all] = 0.0
                for column in np.flatnonzero((hidden > tolerance).any(axis=0)):
                    k = int((hidden - tolerance)[:, column].argmax())
                    ends, mean = (float(time[k]), float(time[k + 1])), float(hidden[k, column])
                    _keep_worst(worst, MissedMotion(names[bodies[column]], *ends, rate, mean))
    return list(worst.values())


def _is_whole(group: h5py.Group, word: str) -> bool:
    """Whether all components of a motion are written."""
    return word in group and all(axis in group[word] for axis in "xyz")


def _keep_worst(worst: dict[str, MissedMotion], one: MissedMotion) -> None:
    """Keep that of a body with the first of the rates, of these the largest. Writes: worst."""
    known = worst.get(one.name)
    if known is None or (-ORDER[one.rate], one.hidden) > (-ORDER[known.rate], known.hidden):
        worst[one.name] = one


def _begin_of_motion(phases: Sequence[Phase]) -> float:
    """Time [s] after which nothing but forces changes velocities; inf for none."""
    if phases and phases[-1].module.__name__.endswith("equilibrium"):
        return inf
    return phases[-2].end if len(phases) > 1 else -inf


def _pieces(
    group: h5py.Group, words: list[str], bodies: list[int]
) -> Iterator[tuple[slice, np.ndarray, dict[str, np.ndarray]]]:
    """Rows, times (n,) and motions (3, n, bodies) of successive samples, which overlap."""
    time = group["time"][:]
    # rows that are reserved and were not written
    time = time[np.isfinite(time)]
    count = max(PIECE // max(len(bodies), 1), 8)
    columns = slice(None) if len(bodies) == len(group["ids"]) else bodies
    for first in range(0, len(time) - 1, count):
        rows = slice(max(first - 1, 0), min(first + count + 3, len(time)))
        yield (
            rows,
            time[rows],
            {w: np.array([group[w][axis][rows][:, columns] for axis in "xyz"]) for w in words},
        )


def _hidden(
    time: np.ndarray, x: np.ndarray, v: np.ndarray, noise: float, rest: float
) -> tuple[np.ndarray, np.ndarray]:
    """What the samples of v do not show of the change of x in each interval, over its length, and
    how much of it resolved motions have (n - 1, bodies); `noise` is the error of a change of x,
    and `rest` of that over a rate.
    """
    dt = np.diff(time)[:, None]
    hidden = _sizes(np.diff(x, axis=1) / dt - 0.5 * (v[:, 1:] + v[:, :-1]))
    # of each interval the samples at its ends and the next ones
    about, count = np.concatenate([v[:, :1], v, v[:, -1:]], axis=1), len(dt)
    sizes = _sizes(about)
    high = low = about[:, :count]
    largest = sizes[:count]
    for k in range(1, 4):
        high = np.maximum(high, about[:, k : k + count])
        low = np.minimum(low, about[:, k : k + count])
        largest = np.maximum(largest, sizes[k : k + count])
    return hidden, SPREAD * _sizes(high - low) + SHARE * largest + noise / dt + rest / dt**2


def _sizes(x: np.ndarray) -> np.ndarray:
    """Sizes (n, bodies) of vectors (3, n, bodies)."""
    return np.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])


def _largest(x: np.ndarray) -> float:
    """Largest size of vectors (3, n, bodies)."""
    return float(_sizes(x).max(initial=0.0))
