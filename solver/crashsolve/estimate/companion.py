"""A companion: the deck's model run again in memory, coarser or finer, for watched channels.

    coarseness m: fixed or longest step, safety and rotation times m; tolerance times m^q

q is the order of a step's error, 5 at most. A fixed step has a tolerance too: joints are closed and
stages solved by it. Where samples bound its steps, a coarser companion goes from every m-th of them
to the next. From equilibrium to equilibrium a finer one takes 1/m load steps.
Consequence to test: a companion of coarseness 1 gives the samples of the run to the bit.
"""

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import SolverError
from crashsolve.model.build import build
from crashsolve.model.model import Model, State
from crashsolve.recording.engines import Prepared, is_static, prepared_engine
from crashsolve.recording.histories import Histories
from crashsolve.recording.marching import MAX_BLOCK_SAMPLES
from crashsolve.recording.resampling import Resampling
from crashsolve.recording.samples import Channel, Samples, find, gather, needed_for
from crashsolve.recording.sampling import Schedule
from crashsolve.study.methods import order_of
from crashsolve.system.engine import Engine

# where the error of a step is of higher order the step falls by a factor between 1.5 and 2
HIGHEST_POWER = 5
# samples that bound the step, of one block: which they are is computed one by one
SAMPLES_AHEAD = 64


class Abandoned(Exception):
    """The run has been asked to stop."""


class BudgetExceeded(Exception):
    """A companion has used up the CPU time that is left for it."""


def coarsen(control: np.ndarray, coarseness: float, interval: float, order: float | None) -> None:
    """Make the steps longer, or shorter, than the deck has them. Writes: control.

    `interval` [s] is that of the samples, which bound automatic steps; `order` the method's.
    """
    c = control[0]
    if coarseness == 1.0:
        return
    power = min((order or HIGHEST_POWER) + 1, HIGHEST_POWER)
    c["tolerance"] = min(c["tolerance"] * coarseness**power, 0.5)
    c["curve_share"] *= coarseness
    if c["fixed_step"] > 0.0:
        c["fixed_step"] *= coarseness
        return
    # samples do not cut the steps of the default method that chooses them
    longest = c["step_max"] if c["resolves"] == 1 else min(c["step_max"], interval)
    c["step_max"] = longest * coarseness
    c["safety"] *= coarseness
    c["rotation"] *= coarseness


class Companions:
    """Runs of one deck in memory; `stopped` returns whether the user has stopped the run."""

    def __init__(
        self,
        deck: Deck,
        channels: Sequence[Channel],
        stopped: Callable[[], bool],
        prepared: Prepared,
    ) -> None:
        """`prepared` comes from the run, or is empty."""
        # model and state for the first of these runs, where they have been built already
        self.built: tuple[Model, State] | None = None
        self.deck, self.channels, self.stopped = deck, channels, stopped
        self.prepared = prepared
        self.order = order_of(deck.control.integrator)
        # CPU time [s] that is left for all runs, and of the process when this one must end
        self.budget, self._until = inf, inf

    def run(self, coarseness: float) -> Samples:
        """Samples of the channels. Raises SolverError, Abandoned, BudgetExceeded."""
        start_time = clock.process_time()
        self._until = start_time + self.budget
        try:
            return self._run(coarseness, start_time)
        finally:
            self.budget -= clock.process_time() - start_time

    def _run(self, coarseness: float, start_time: float) -> Samples:
        schedule = Schedule.of(self.deck)
        model, state = self.built or build(self.deck)
        self.built = None
        if not is_static(self.deck):
            coarsen(model.control, coarseness, schedule.interval, self.order)
        engine, self.prepared = prepared_engine(self.deck, model, state, self.prepared)
        engine.on_pause = engine.on_iteration = self._check_limits
        recorded = _RecordedSamples(engine, Histories(engine, needed_for(self.channels)))
        kept = recorded.histories.kept
        resampling = Resampling(engine, kept, not is_static(self.deck), recorded.take)
        engine.start()
        engine.model.control["gaps"] = recorded.histories.needs_gaps
        k = self._sample(0, recorded, resampling, schedule)
        while not schedule.is_end(k):
            self._check_limits()
            if is_static(self.deck):
                self._take_load_steps(engine, schedule.time(k), schedule.time(k + 1), coarseness)
                k = self._sample(k + 1, recorded, resampling, schedule)
                continue
            # where samples bound its steps it leaves some of them out
            longest = _longest(schedule) if coarseness >= 2.0 else inf
            is_bound = float(engine.clock["next_step"]) > longest
            march = resampling.march
            most = SAMPLES_AHEAD if march.can_march(schedule.time(k)) else 1
            numbers, times = _ahead(k, most, is_bound, coarseness, schedule)
            if march.can_march(float(times[-1])):
                march.job.shortest, march.job.longest = (
                    (longest, inf) if is_bound else (-inf, longest)
                )
                count, _, left = march.go(times)
                recorded.add(times[:count].tolist())
                if left is not None:
                    engine.answer(left)
                k = numbers[count - 1] if count else k
                # of samples that are left out none may be taken within an interval
                if march.is_at_sample() or count and not is_bound:
                    continue
                numbers = numbers[count:]
            k = numbers[0]
            resampling.reach(schedule.time(k))
            resampling.sample_steps(schedule.time(k))
            self._sample(k, recorded, resampling, schedule)
        recorded.close()
        # fewer channels than those of the run
        families = recorded.histories.families
        own = [find(channel.name, families)[0] for channel in self.channels]
        samples = gather(recorded.times, recorded.blocks, own)
        cpu_time = clock.process_time() - start_time
        return replace(samples, cycles=int(engine.clock["cycle"]), cpu=cpu_time)

    def _sample(
        self, k: int, recorded: "_RecordedSamples", resampling: Resampling, schedule: Schedule
    ) -> int:
        """Take sample k, with which an interval begins; returns k. Raises SolverError."""
        recorded.engine.sample(schedule.time(k))
        resampling.begin_interval()
        recorded.take(schedule.time(k))
        return k

    def _check_limits(self) -> None:
        if self.stopped():
            raise Abandoned
        if clock.process_time() > self._until:
            raise BudgetExceeded

    def _take_load_steps(
        self, engine: Engine, start_time: float, end: float, coarseness: float
    ) -> None:
        """Go from one sample to the next in 1 / coarseness load steps."""
        count = max(round(1.0 / coarseness), 1)
        for i in range(1, count + 1):
            engine.reach(end if i == count else start_time + (end - start_time) * i / count)


def _ahead(
    k: int, most: int, is_bound: bool, coarseness: float, schedule: Schedule
) -> tuple[Sequence[int], np.ndarray]:
    """Numbers and times [s] of the samples after sample k; where they bound the step, `most`."""
    if not is_bound:
        times = schedule.times(k + 1, MAX_BLOCK_SAMPLES)
        return range(k + 1, k + 1 + len(times)), times
    numbers: list[int] = []
    while len(numbers) < most and not schedule.is_end(k):
        k = _next(k, coarseness, schedule)
        numbers.append(k)
    return numbers, np.array([schedule.time(i) for i in numbers])


def _next(k: int, coarseness: float, schedule: Schedule) -> int:
    """Number of the next sample where a step would pass the next one: that of every m-th.

    No sample at a requested time is left out.
    """
    stride, plain = 1, schedule.plain_number(k)
    while plain is not None and 2 * stride <= coarseness and plain % (2 * stride) == 0:
        stride *= 2
    for following in range(k + 1, k + stride):
        if schedule.plain_number(following) is None:
            return following
    while schedule.time(k) == schedule.time(k + stride) or schedule.is_end(k + stride - 1):
        stride -= 1
    return k + stride


def _longest(schedule: Schedule) -> float:
    """Longest step [s] that the samples do not bound."""
    return schedule.interval * (1.0 + 1e-9)


class _RecordedSamples:
    """Times and blocks of the samples of a companion."""

    def __init__(self, engine: Engine, histories: Histories) -> None:
        self.engine, self.histories = engine, histories
        self.times: list[float] = []
        self.blocks: list[dict[str, np.ndarray]] = []

    def take(self, time: float, is_stored: bool = False) -> None:
        """Keep the present sample, unless it has been stored already. Raises SolverError."""
        if not is_stored:
            self.histories.take()
        self.add([time])

    def add(self, times: list[float]) -> None:
        """Add the times [s] of samples that the engine has recorded itself. Raises SolverError."""
        self.times += times
        if self.histories.kept.is_full:
            self.close()

    def close(self) -> None:
        """Compute the channels of the samples recorded since the last time. Raises SolverError."""
        if self.histories.kept.count == 0:
            return
        # the next samples overwrite them
        block = {name: values.copy() for name, values in self.histories.values().items()}
        if not all(np.isfinite(values).all() for values in block.values()):
            raise _not_finite(self.engine)
        self.blocks.append(block)


def _not_finite(engine: Engine) -> SolverError:
    now, cycle = float(engine.clock["time"]), int(engine.clock["cycle"])
    return SolverError(now, cycle, "the model", "a channel is not a finite number any more")
