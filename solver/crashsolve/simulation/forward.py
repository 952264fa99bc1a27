"""From sample to sample until the end of a run, in blocks where no sample needs Python."""

import time
from bisect import bisect_left
from pathlib import Path
from typing import Protocol

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.output.states import StateWriter
from crashsolve.recording.histories import Histories
from crashsolve.recording.marching import MAX_BLOCK_SAMPLES
from crashsolve.recording.recorder import Recorder
from crashsolve.recording.resampling import Resampling
from crashsolve.recording.sampling import Schedule
from crashsolve.simulation.event_states import EventStates
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.simulation.phases import ContactPhases
from crashsolve.simulation.progress import Account
from crashsolve.simulation.requests import Requests
from crashsolve.system.engine import Engine


class Run(Protocol):
    """Attributes and functions of a run that the loop over samples needs."""

    deck: Deck
    engine: Engine
    folder: Path
    schedule: Schedule
    histories: Histories
    resampling: Resampling
    recorder: Recorder
    events: EventStates
    states: StateWriter
    account: Account
    heartbeat: Heartbeat
    requests: Requests
    cpu: dict[str, float]
    sampled: float  # time of the last sample [s]
    log_step: float
    state_step: float
    restart_step: float | None

    def passed(self, time: float, step: float) -> float: ...
    def write(self, now: float, force: bool) -> None: ...
    def handle_requests(self) -> None: ...


def march(run: Run) -> None:
    """Advance from sample to sample until the end."""
    end = run.schedule.end
    run.heartbeat.does("one step")
    marching = run.resampling.march
    run.account.phases = ContactPhases(marching)
    run.sampled = float(run.engine.clock["sampled"])
    k = run.schedule.last_until(run.sampled)
    target = run.schedule.time(k)
    run.resampling.begin()
    run.events.begin()
    while target < end and not run.engine.is_complete:
        times = _times_ahead(run, k)
        if marching.can_march(float(times[-1])):
            count = _march_through(run, times)
            k += count
            target = run.schedule.time(k)
            if count == len(times):
                continue
        k += 1
        target = _go_to(run, run.schedule.time(k))
    _write_events(run)


def _write_events(run: Run) -> None:
    """States at events, which the run must reach again."""
    started = time.process_time()
    run.recorder.flush()
    run.events.write(run.states, run.folder / "history.h5", lambda: _is_requested(run))
    run.cpu["output"] += time.process_time() - started


def _is_requested(run: Run) -> bool:
    run.requests.read()
    return bool(run.requests.words)


def _march_through(run: Run, times: np.ndarray) -> int:
    """Samples at times [s] in compiled code; how many are done. Raises SolverError."""
    # a run has no child processes between samples: their CPU times are not needed
    started = time.process_time()
    count, stepping, left = run.resampling.march.go(times)
    if count:
        # before any request that writes a dump
        run.recorder.add_stored(times[:count].tolist())
        previous = times[count - 2] if count > 1 else run.sampled
        run.sampled, now = float(previous), float(times[count - 1])
        if count == len(times):
            _after(run, now)
        run.sampled = now
    run.cpu["steps"] += stepping
    run.cpu["output"] += time.process_time() - started - stepping
    if left is not None:
        run.engine.answer(left)
    return count


def _go_to(run: Run, target: float) -> float:
    """Advance to one sample and take it; its time, which may be another of an equilibrium."""
    started = time.process_time()
    try:
        run.resampling.reach(target)
    finally:
        advanced = time.process_time()
        run.cpu["steps"] += advanced - started
    if run.engine.is_complete:
        target = float(run.engine.clock["time"])
    run.resampling.sample_steps(target)
    run.engine.sample(target)
    run.resampling.begin_interval()
    run.resampling.march.finish_interval()
    run.recorder.take(target)
    _after(run, target)
    run.cpu["output"] += time.process_time() - advanced
    return target


def _after(run: Run, now: float) -> None:
    """Actions after a sample, the last of those taken."""
    run.account.keep_alive()
    run.write(now, force=now == run.schedule.end or run.engine.is_complete)
    run.sampled = now
    run.handle_requests()


def _times_ahead(run: Run, k: int) -> np.ndarray:
    """Times [s] of the samples after sample k, up to the first at which more is due."""
    steps = [step for step in (run.state_step, run.log_step, run.restart_step) if step]
    # by then one of these is due
    until_due = min(steps) / run.schedule.interval + 2.0
    most = min(MAX_BLOCK_SAMPLES, run.histories.kept.room, until_due)
    times = run.schedule.times(k + 1, int(most))
    before = [(step, run.passed(run.sampled, step)) for step in steps]

    def is_due(time: float) -> bool:
        if time >= run.schedule.end:
            return True
        return any(run.passed(time, step) > number for step, number in before)

    return times[: bisect_left(times, True, key=is_due) + 1]
