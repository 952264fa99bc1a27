"""States at events: first touch, largest contact force and first yield, beside those at intervals.

Which sample has the largest force is known at the end alone. So the State is copied whenever one is
written; where an event falls into the time until the next, that copy is kept, and the run goes from
it to the event again, to the same bits, when it has ended. Consequence to test: there is a
state at the sample of the largest force, and all else is as without.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.errors import SolverError
from crashsolve.model.ledger import PLASTIC
from crashsolve.output.states import StateWriter
from crashsolve.recording.changing import Snapshot, is_cheap
from crashsolve.recording.sampling import Schedule
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    import h5py

TOUCH, FORCE, YIELD = "first touch", "largest contact force", "first yield"
# outputs of laws that are 0 until they yield
PLASTIC_OUTPUT = ("plastic", "plastic_angle", "plastic_strain", "set")


class Abandoned(Exception):
    """A request has come in for the run."""


class Reached(Exception):
    """The step of an event has been done."""


class EventStates:
    """Copies of the State before events of a run in time; `fields` makes the fields of a state."""

    def __init__(
        self,
        engine: Engine,
        schedule: Schedule,
        wanted: bool,
        fields: Callable[[], dict[str, dict[str, np.ndarray]]],
    ) -> None:
        self.engine, self._schedule, self._fields = engine, schedule, fields
        # phases pass on more than a State
        is_plain = type(engine) is Engine and is_cheap(engine)
        self._watches, self._is_started = wanted and is_plain, False
        self._snapshot: Snapshot | None = None
        # of every event: the copy before it, and the times before and after it [s]
        self._events: dict[str, tuple[Snapshot, float, float]] = {}

    def begin(self) -> None:
        """Seek events from now on: of those before there is no copy."""
        if self._watches and not self._is_started:
            self._is_started, self._quantities = True, self._event_quantities()
            self._take_snapshot()

    def state_written(self) -> None:
        """A state has been written at the present sample: whether an event lies before it."""
        if not self._watches:
            return
        if not self._is_started or self._snapshot is None:
            return self.begin()
        now, end = self._event_quantities(), float(self.engine.clock["sampled"])
        for name, value in now.items():
            # a run that goes on from a dump may have had its first touch before
            is_first = self._quantities[name] == 0.0
            if value > self._quantities[name] and (name == FORCE or is_first):
                self._events[name] = self._snapshot, self._snapshot_time, end
        self._quantities = now
        self._take_snapshot()

    def write(self, states: StateWriter, history: Path, is_requested: Callable[[], bool]) -> None:
        """Go to the events again. Raises OutputError."""
        if not self._events:
            return
        times, target = self._times(history), float(self.engine.clock["sampled"])
        end, pause = Snapshot(self.engine), self.engine.on_pause
        end.take()
        self.engine.on_pause = _stop(is_requested)
        try:
            for name, (snapshot, started, _) in self._events.items():
                if name in times and not states.has(times[name]):
                    snapshot.restore_copy()
                    self._advance_to(times[name], started)
                    self.engine.sample(times[name])
                    states.insert(times[name], self._fields())
        except (Abandoned, SolverError):
            # the checks of the run itself have been made there
            pass
        finally:
            self.engine.on_pause = pause
            end.restore_copy()
            self.engine.sample(target)

    def _advance_to(self, time: float, started: float) -> None:
        """Advance by the steps of the run to a sample, which may be a step of it.

        Raises SolverError.
        """
        k = self._schedule.last_until(started) + 1
        while self._schedule.time(k) < time:
            self.engine.reach(self._schedule.time(k))
            k += 1
        if self._schedule.time(k) == time:
            return self.engine.reach(time)

        def check() -> None:
            if float(self.engine.clock["time"]) >= time:
                raise Reached

        with suppress(Reached):
            self.engine.revisit(self._schedule.time(k), 1, check)

    def _take_snapshot(self) -> None:
        # one that an event keeps is not overwritten
        if self._snapshot is None or any(
            kept is self._snapshot for kept, _, _ in self._events.values()
        ):
            self._snapshot = Snapshot(self.engine)
        self._snapshot.take()
        self._snapshot_time = float(self.engine.clock["sampled"])

    def _event_quantities(self) -> dict[str, float]:
        """Quantities that grow when an event happens."""
        state, clock = self.engine.state, self.engine.state.clock[0]
        cards = state.card_history[int(clock["current"])]
        yielded = sum(
            np.count_nonzero(group.output[name])
            for group in self.engine.model.groups
            for name in PLASTIC_OUTPUT
            if name in (group.output.dtype.names or ())
        )
        quantities = {YIELD: float(yielded) + float(self.engine.ledger[PLASTIC] > 0.0)}
        if len(self.engine.model.contacts):
            touched = float(np.count_nonzero(cards["onsets"]))
            quantities |= {TOUCH: touched, FORCE: float(cards["peak_normal"].max())}
        return quantities

    def _times(self, history: Path) -> dict[str, float]:
        """The sample [s] of every event: that of its largest value, or the first that has grown."""
        import h5py

        times = {}
        with h5py.File(history, "r") as file:
            for name, (_, started, end) in self._events.items():
                time = file["glstat/time"][:]
                rows = slice(*(np.searchsorted(time, (started, end)) + (0, 1)))
                values = _history(file, name, rows)
                at = int(np.argmax(values if name == FORCE else values > values[0]))
                if at:
                    times[name] = float(time[rows][at])
        return times


def _stop(is_requested: Callable[[], bool]) -> Callable[[], None]:
    """Callback at a pause: raises Abandoned where there is a request to the run."""

    def pause() -> None:
        if is_requested():
            raise Abandoned

    return pause


def _history(file: h5py.File, name: str, rows: slice) -> np.ndarray:
    """Quantities that grow at an event, at rows of a history."""
    if name == TOUCH:
        return np.count_nonzero(file["rcforc/onsets"][rows], axis=1)
    if name == FORCE:
        largest: np.ndarray = file["rcforc/normal"][rows].max(axis=1)
        return largest
    names = [f"{family}/{path}" for family in file for path in PLASTIC_OUTPUT]
    items = [file[path] for path in ("glstat/energy/plastic", *names) if path in file]
    # of a vector, a group of its components
    sets = [part for one in items for part in (one.values() if hasattr(one, "values") else [one])]
    columns = [part[rows] for part in sets]
    return np.count_nonzero(np.column_stack(columns), axis=1)
