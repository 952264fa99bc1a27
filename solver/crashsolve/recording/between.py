"""Samples at the steps of an interval in which contacts bore what its ends do not show.

A contact that touches and releases between two samples leaves nothing in them. Its peak and its
impulse I, which are of all steps, say so:

    peak:     the largest normal force has grown, and neither end shows SHOWN of it
    impulse:  |dI - (F_0 + F_1) dt / 2| is more than PART of the sum of |dI| so far

Then the interval is run once more from its start, to the same bits, with a sample at every step, so
that extremes, integrals and functions of all channels know what happened. Consequence to test: the
peak of the samples is that of the steps, whatever their interval, and the run is as without.
"""

from collections.abc import Callable
from contextlib import suppress
from math import ceil

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.recording.changing import Snapshot, size_of
from crashsolve.system.engine import Engine

SHOWN, PART = 0.9, 0.1
# rows of one interval at most
MOST_ROWS = 512
# steps that are run once more: so many, and this share of all
FREE_STEPS, SHARE = 4000, 0.05
# [bytes] models beyond this are not copied at every sample
MOST_BYTES = 1 << 26


class Between:
    """Watches the intervals of a run in time; `take` keeps the engine's present sample at a time.

    `spent` (1,) are steps that were run once more, `borne` (cards,) [N s] the sums of |dI|
    in intervals of several steps.
    """

    def __init__(self, engine: Engine, moves: bool, take: Callable[[float], None]) -> None:
        self.engine, self._take = engine, take
        self.spent, self.borne = np.zeros(1), np.zeros(len(engine.model.contacts))
        self.watches = moves and len(self.borne) > 0 and size_of(engine) < MOST_BYTES
        # whether an interval has begun
        self.is_marked = False
        if self.watches:
            self._begin, self._end = Snapshot(engine), Snapshot(engine)

    def memory(self) -> dict[str, np.ndarray]:
        """What a restart must bring back."""
        if not self.is_marked:
            return {}
        kept = {"spent": self.spent, "borne": self.borne}
        kept |= {"mark": np.array([self._time, self._cycle], float)}
        kept |= {"card": self._card.view(np.uint8), "history": self._history.view(np.uint8)}
        kept |= {f"begin/{name}": array for name, array in self._begin.arrays().items()}
        return {f"between/{name}": array for name, array in kept.items()}

    def recall(self, arrays: dict[str, np.ndarray]) -> None:
        """Take up what `memory` gave away, if it had begun. Raises KeyError or ValueError."""
        if not self.watches or "between/mark" not in arrays:
            return
        found = {
            name.removeprefix("between/"): a
            for name, a in arrays.items()
            if name.startswith("between/")
        }
        self.spent[...], self.borne[...] = found["spent"], found["borne"]
        self._time, self._cycle = float(found["mark"][0]), int(found["mark"][1])
        state = self.engine.state
        self._card = found["card"].view(state.cards.dtype)
        self._history = found["history"].view(state.card_history.dtype)
        begin = {n.removeprefix("begin/"): a for n, a in found.items() if n.startswith("begin/")}
        self._begin.recall(begin)
        self.is_marked = True

    def begin(self) -> None:
        """The first interval begins, unless a restart has brought it back."""
        if not self.is_marked:
            self.mark()

    def mark(self) -> None:
        """An interval begins at the present sample."""
        if self.watches:
            self._begin.take()
            self._time, self._cycle, self._card, self._history = self._look()
            self.is_marked = True

    def fill(self, until: float) -> None:
        """Sample at steps of the interval up to its end, `until` [s], if that is due."""
        if not self.watches or not self._hides():
            return
        steps = int(self.engine.clock["cycle"]) - self._cycle
        if self.spent[0] + steps > FREE_STEPS + SHARE * float(self.engine.clock["cycle"]):
            return
        self.spent += steps
        self._end.take()
        self._begin.put_back()
        self.engine.revisit(until, ceil(steps / MOST_ROWS), self._sample)
        self._end.put_back()

    def _sample(self) -> None:
        """Take the present step as a sample."""
        # the run itself has judged this interval already
        with suppress(SolverError):
            self.engine.sample()
            self._take(float(self.engine.clock["time"]))

    def _hides(self) -> bool:
        """Whether the ends of the interval show too little of any contact. Writes: borne."""
        # of one step both ends are samples
        if self.engine.state.clock[0]["cycle"] - self._cycle < 2:
            return False
        time, _, card, history = self._look()
        change = history["impulse"] - self._history["impulse"]
        seen = 0.5 * (time - self._time) * (self._card["force"] + card["force"])
        known, lack = self.borne.copy(), np.linalg.norm(change - seen, axis=1)
        self.borne += np.linalg.norm(change, axis=1)
        peak, shown = history["peak_normal"], np.maximum(self._card["normal"], card["normal"])
        has_peak = (peak > self._history["peak_normal"]) & (shown < SHOWN * peak)
        has_impulse = (known > 0.0) & (lack > PART * self.borne)
        return bool(np.any(has_peak | has_impulse))

    def _look(self) -> tuple[float, int, np.ndarray, np.ndarray]:
        """Time [s], cycle, contact cards and what they remember."""
        state = self.engine.state
        clock = state.clock[0]
        history = state.card_history[int(clock["current"])].copy()
        return float(clock["time"]), int(clock["cycle"]), state.cards.copy(), history
