"""Samples at the steps of an interval whose ends miss forces of contact, or an acceleration.

A contact that begins and ends between two samples is in none of them. Its peak and its impulse,
which are of all steps, reveal it (march.py), and so does the velocity of an accelerometer that has
a role in measures of injury. Then the interval is run again, from its start or its first step, to
the same bits, with a sample at every step, so that extremes, integrals and functions of all
channels include it. Consequence to test: the peak of the samples is that of the steps,
whatever their interval, and the run is as without.
"""

from collections.abc import Callable
from contextlib import suppress
from math import ceil

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.recording.changing import Snapshot, is_cheap
from crashsolve.recording.kept import Block
from crashsolve.recording.marching import March, has_probes
from crashsolve.system.engine import Engine

# rows of one interval at most
MAX_ROWS = 512
# steps that are run again: so many, and this share of all
FREE_STEPS, REPEATED_SHARE = 4000, 0.05


class Resampling:
    """Watches the intervals of a run in time; `take` stores the present sample of the engine at a
    time, in `kept`, unless it is stored there already.

    `march` counts and watches them; `repeated` (1,) are steps that were run again.
    """

    def __init__(
        self, engine: Engine, kept: Block, moves: bool, take: Callable[[float, bool], None]
    ) -> None:
        self.engine, self._take = engine, take
        self.repeated = np.zeros(1)
        has_forces = bool(engine.model.contacts) or has_probes(engine.model)
        # whether samples may come between those of the schedule
        self.watches = moves and has_forces and is_cheap(engine)
        self._begin, self._end = (Snapshot(engine) if self.watches else None for _ in range(2))
        self.march = March(engine, kept, self._begin)
        # whether an interval has begun
        self.has_begun = False

    def memory(self) -> dict[str, np.ndarray]:
        """Arrays that a restart must restore."""
        if not self.has_begun or self._begin is None:
            return {}
        kept: dict[str, np.ndarray] = {"repeated": self.repeated}
        kept |= {"watch": self.march.watch_table.view(np.uint8)}
        kept |= {"marks": self.march.marks.view(np.uint8)}
        kept |= {"probes": self.march.probes.view(np.uint8)}
        if self.march.watch.copied:
            kept |= {f"begin/{name}": array for name, array in self._begin.arrays().items()}
        return {f"between/{name}": array for name, array in kept.items()}

    def recall(self, arrays: dict[str, np.ndarray]) -> None:
        """Restore the arrays of `memory`, if it had begun. Raises KeyError or ValueError."""
        if self._begin is None or "between/watch" not in arrays:
            return
        own = {
            name.removeprefix("between/"): a
            for name, a in arrays.items()
            if name.startswith("between/")
        }
        self.repeated[...] = own["repeated"]
        self.march.watch_table.view(np.uint8)[...] = own["watch"]
        self.march.marks.view(np.uint8)[...] = own["marks"]
        self.march.probes.view(np.uint8)[...] = own["probes"]
        if self.march.watch.copied:
            self._begin.recall(
                {n.removeprefix("begin/"): a for n, a in own.items() if n.startswith("begin/")}
            )
        self.has_begun = True

    def begin(self) -> None:
        """Begin the first interval, unless a restart has restored one."""
        if not self.has_begun:
            self.begin_interval()

    def begin_interval(self) -> None:
        """Begin an interval at the present sample."""
        self.march.begin()
        self.has_begun = True

    def reach(self, until: float) -> None:
        """Step to a sample at `until` [s]. Raises SolverError."""
        if self.watches:
            self.march.take_snapshot()
        self.engine.reach(until)

    def sample_steps(self, until: float) -> None:
        """Sample at steps of the interval up to its end, `until` [s], if that is due."""
        if self._begin is None or self._end is None or not self.march.ask():
            return
        steps = int(self.engine.clock["cycle"]) - int(self.march.watch.cycle)
        if self.repeated[0] + steps > FREE_STEPS + REPEATED_SHARE * float(
            self.engine.clock["cycle"]
        ):
            return
        self.repeated += steps
        self._end.take()
        self._begin.restore_copy()
        stride = ceil(steps / MAX_ROWS)
        done = int(self.engine.clock["cycle"]) - int(self.march.watch.cycle)
        if done and done % stride == 0:
            self._sample()
        self.engine.revisit(until, stride, self._sample, done % stride)
        self._end.restore_copy()

    def _sample(self) -> None:
        """Take the present step as a sample."""
        # the run has checked this interval already
        with suppress(SolverError):
            is_stored = self.march.look()
            if is_stored is None:
                self.engine.sample()
            if is_stored is not False:
                self._take(float(self.engine.clock["time"]), bool(is_stored))
