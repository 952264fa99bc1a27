"""Rigid bodies whose motion between two samples is not that of the samples.

    h = |dv - (a_0 + a_1) dt / 2| / dt    of velocities and accelerations, of both translation and
    rotation, and of positions and velocities, beyond

    SPREAD x (range of a over four samples) + SHARE x (largest |a| of them) + ROUND_OFF / dt

A stop, a spring with a gap or a belt may catch a body and release it within one interval, and a
vibration may have a whole number of periods in it. Where samples resolve a motion, h is the error
of the trapezoidal rule; where a force begins within an interval it is half the range of a at most.
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
PIECE = 1 << 16
# a motion and its rate, and the errors of the former
RATES = (
    ("velocity", "acceleration", RATE_ROUND_OFF),
    ("angular_velocity", "angular_acceleration", RATE_ROUND_OFF),
    ("position", "velocity", ROUND_OFF),
)


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
            "(SI) from what they show: largest values and integrals of forces and motions, HIC and "
            "filters miss it; give a shorter output.history.interval"
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
        for motion, rate, round_off in RATES:
            # a run whose errors are estimated writes them (recording/selection.py)
            if not {motion, rate} <= file["rbdout"].keys():
                continue
            least = 0.0
            if motion == "angular_velocity" and set(RATES[2][:2]) <= file["rbdout"].keys():
                speeds = (_largest(v) for _, _, v in _pieces(file["rbdout"], *RATES[2][:2], bodies))
                least = max(speeds, default=0.0) / engine.model.size
            for time, x, v in _pieces(file["rbdout"], motion, rate, bodies):
                noise = round_off * max(_largest(x), least)
                hidden, tolerance = _hidden(time, x, v, noise, REST * engine.model.size)
                hidden[time[:-1] <= begin] = 0.0
                for column in np.flatnonzero((hidden > tolerance).any(axis=0)):
                    name = names[bodies[column]]
                    k = int((hidden - tolerance)[:, column].argmax())
                    ends, mean = (float(time[k]), float(time[k + 1])), float(hidden[k, column])
                    if name not in worst or worst[name].rate == rate and worst[name].hidden < mean:
                        worst[name] = MissedMotion(name, *ends, rate, mean)
    return list(worst.values())


def _begin_of_motion(phases: Sequence[Phase]) -> float:
    """Time [s] after which nothing but forces changes velocities; inf for none."""
    if phases and phases[-1].module.__name__.endswith("equilibrium"):
        return inf
    return phases[-2].end if len(phases) > 1 else -inf


def _pieces(
    group: h5py.Group, motion: str, rate: str, bodies: list[int]
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Times (n,), a motion and its rate (n, bodies, 3) of successive samples, which overlap."""
    time = group["time"][:]
    # rows that are reserved and were not written
    time = time[np.isfinite(time)]
    count = max(PIECE // max(len(bodies), 1), 8)
    for first in range(0, len(time) - 1, count):
        rows = slice(max(first - 1, 0), first + count + 3)
        x, v = (
            np.stack([group[word][axis][rows][:, bodies] for axis in "xyz"], axis=-1)
            for word in (motion, rate)
        )
        kept = time[rows]
        yield kept, x[: len(kept)], v[: len(kept)]


def _hidden(
    time: np.ndarray, x: np.ndarray, v: np.ndarray, noise: float, rest: float
) -> tuple[np.ndarray, np.ndarray]:
    """What the samples of v do not show of the change of x in each interval, over its length, and
    how much of it resolved motions have (n - 1, bodies); `noise` is the error of a change of x,
    and `rest` of that over a rate.
    """
    dt = np.diff(time)[:, None]
    hidden = np.linalg.norm(np.diff(x, axis=0) / dt[..., None] - 0.5 * (v[1:] + v[:-1]), axis=2)
    # of each interval the samples at its ends and the next ones
    about = np.pad(v, ((1, 1), (0, 0), (0, 0)), mode="edge")
    four = np.stack([about[k : k + len(dt)] for k in range(4)])
    spread = np.linalg.norm(four.max(axis=0) - four.min(axis=0), axis=2)
    largest = np.linalg.norm(four, axis=3).max(axis=0)
    return hidden, SPREAD * spread + SHARE * largest + noise / dt + rest / dt**2


def _largest(x: np.ndarray) -> float:
    """Largest size of vectors (n, bodies, 3)."""
    return float(np.linalg.norm(x, axis=2).max(initial=0.0))
