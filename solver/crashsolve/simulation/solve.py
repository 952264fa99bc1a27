"""One run: deck to results. Read, build, compose, advance, write.

Requests during the run, by signals and in control.txt, are those of requests.py.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.compiler.cache import notes as cache_notes
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import (
    CrashsolveError,
    DeckError,
    ExitCode,
    RunStopped,
    out_of_memory,
)
from crashsolve.foundation.streams import print_line
from crashsolve.model.build import build
from crashsolve.model.integrator_selection import with_chosen_method
from crashsolve.output.errors import OutputError
from crashsolve.output.files import Json, reported
from crashsolve.output.history import HistoryWriter
from crashsolve.output.lock import Lock
from crashsolve.output.log import ERROR, NORMAL, STOPPED, Log
from crashsolve.output.peaks import write_peaks
from crashsolve.output.restart import SLOTS, newest_restart, write_restart
from crashsolve.output.states import StateWriter
from crashsolve.output.status import State as RunState
from crashsolve.recording.changing import changing, restore
from crashsolve.recording.engines import Prepared, is_static, prepared_engine
from crashsolve.recording.histories import Histories
from crashsolve.recording.marching import compile_march_ahead
from crashsolve.recording.recorder import Recorder
from crashsolve.recording.resampling import Resampling
from crashsolve.recording.sampling import Schedule
from crashsolve.simulation.event_states import EventStates
from crashsolve.simulation.expected_size import expected_size
from crashsolve.simulation.forward import march
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.simulation.inconsistencies import refuse_inconsistencies
from crashsolve.simulation.pictures import Pictures
from crashsolve.simulation.progress import Account, cpu_time, end_at_once, preparing, provenance
from crashsolve.simulation.remarks import contacts_without_depth, touching_at_start
from crashsolve.simulation.requests import Requests, interrupt_as_keyboard
from crashsolve.simulation.resume import FREE, OF_ERRORS, clear_folder, differing
from crashsolve.simulation.shell_steps import remark_on_safety
from crashsolve.simulation.totals import write_totals
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from crashsolve.estimate.runner import Estimating
    from crashsolve.output.restart import Dump
    from crashsolve.simulation.missed_motions import MissedMotion

# of the steps that an accuracy needs, in a restart dump
COARSENESS = "run/coarseness"


def solve(deck_path: Path, folder: Path, overrides: Mapping[str, str], restart: bool) -> int:
    """Run a deck and write its results; returns the exit code. Raises CrashsolveError."""
    interrupt_as_keyboard()
    with Heartbeat(f"reading {deck_path.name}", print_line) as heartbeat:
        return _solve(deck_path, folder, overrides, restart, heartbeat)


def _solve(
    deck_path: Path, folder: Path, overrides: Mapping[str, str], restart: bool, heartbeat: Heartbeat
) -> int:
    started, wall_begun = cpu_time(), time.monotonic()
    deck = read_deck(deck_path, overrides)
    heartbeat.does("building the model")
    was_read = cpu_time()
    compile_march_ahead()
    model, state = build(deck)
    if not is_static(deck):
        deck = with_chosen_method(deck, model)
    with reported(folder):
        folder.mkdir(parents=True, exist_ok=True)
    with Lock(folder) as lock:
        built = cpu_time()
        heartbeat.does("compiling the step")
        going_on = restart and any((folder / slot).exists() for slot in SLOTS)
        with preparing(deck, folder, heartbeat, going_on) as log:
            engine, prepared = prepared_engine(deck, model, state, does=heartbeat.does)
            cpu_seconds = {
                "start of Python": started,
                "read": was_read - started,
                "build": built - was_read,
            }
            cpu_seconds |= {"compile or load": cpu_time() - built, "steps": 0.0, "output": 0.0}
            run = Run(deck, engine, prepared, folder, cpu_seconds, wall_begun, heartbeat, log)
            dump = run.prepare(restart)
        return run.execute(dump, [*filter(None, [lock.warning]), *cache_notes])


class Run:
    """A deck being solved into a results folder."""

    def __init__(
        self,
        deck: Deck,
        engine: Engine,
        prepared: Prepared,
        folder: Path,
        cpu_seconds: dict[str, float],
        wall_begun: float,
        heartbeat: Heartbeat,
        log: Log,
    ) -> None:
        self.deck, self.engine, self.folder, self.heartbeat = deck, engine, folder, heartbeat
        self.prepared, self.log = prepared, log
        self.cpu, self.wall_begun = cpu_seconds, wall_begun
        self.requests = Requests(folder, log, lambda: end_at_once(log, self.account))
        self.files = ExitStack()
        self.is_estimated = self.has_begun = False
        self.estimating: Estimating | None = None
        self.motions: list[MissedMotion] | None = None
        self.overlapping: list[str] = []
        self.schedule = Schedule.of(deck)
        self.history_step = self.schedule.interval
        self.sampled = self.schedule.start
        span, out = self.schedule.end - self.schedule.start, deck.output
        self.state_step = out.states.interval or span / 50 or 1.0
        self.log_step = out.log.interval or span / 20 or 1.0
        self.restart_step = out.restart.every

    def prepare(self, restart: bool) -> Dump | None:
        """Clear the folder, or find the dump to continue from; open the log. Raises OutputError."""
        self.notes: list[str] = []
        dump = newest_restart(self.folder, self.notes.append) if restart else None
        if not restart:
            clear_folder(self.folder)
        elif dump is None:
            self.notes.append("no restart dump in the folder: the run begins anew")
        requested = self.deck.output.states.interval
        if requested is not None and requested < self.history_step:
            text = f"states are written with the samples, {self.history_step:.3g} s apart"
            self.notes.append(text)
        self.account = Account(
            self.deck, self.engine, self.folder, self.log, self.cpu, self.wall_begun, self.heartbeat
        )
        self.requests.catch()
        return dump

    def execute(self, dump: Dump | None, notes: list[str]) -> int:
        """The whole run. Raises SolverError, RunStopped, OutputError after flushing."""
        self.heartbeat.print_line = self.account.print_line
        try:
            self.account.banner()
            for text in (*notes, *self.notes, *self.engine.model.warnings):
                self.log.warning(text)
            self._begin(dump)
            march(self)
            self.engine.finish()
            while self._misses_its_accuracy():
                self._start_anew()
                march(self)
                self.engine.finish()
            self._end("finished", ExitCode.NORMAL, "")
            return ExitCode.NORMAL
        except RunStopped as stop:
            # it is ending: a second interrupt would come too late to change that
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            self.log.line(str(stop))
            self._end("stopped", ExitCode.STOPPED, str(stop))
            raise
        except Exception as error:
            self._fail(error)
            raise

    def _fail(self, error: Exception) -> None:
        """Report the error and save the results so far; the first error is the one that counts."""
        code, message = ExitCode.INTERNAL, f"internal: {error!r}"
        if isinstance(error, MemoryError):
            code, message = ExitCode.OUTPUT, out_of_memory()
        if isinstance(error, CrashsolveError):
            code, message = ExitCode(error.exit_code), str(error)
        for act in (
            lambda: self.log.error(message),
            self.files.close,
            lambda: self.account.status("failed", code, message),
            lambda: write_totals(self.account),
            lambda: self.log.finish(ERROR),
        ):
            with suppress(OutputError):
                act()

    def _begin(self, dump: Dump | None) -> None:
        """Read the dump, if any; prepare the estimates; open the files."""
        # both measure from the start of the run, also after a restart
        self._use_engine(self.engine)
        if self.deck.output.report:
            from crashsolve.recording.pictured import look_up_pictured

            look_up_pictured(self.deck, self.engine.model)
        resumed = None if dump is None else self._restore(*dump)
        self._prepare_estimates(dump)
        self._open(resumed)

    def _use_engine(self, engine: Engine) -> None:
        """Make this the engine of the run, whose state is written and whose requests are met."""
        self.engine = self.account.engine = engine
        engine.on_pause = self._handle_requests_at_once
        engine.on_iteration = self._stop_at_once
        engine.on_message = self.log.line
        written = None
        if self.deck.output.history.channels is not None:
            from crashsolve.recording.selection import written_channels

            written = written_channels(self.deck, engine.model, engine.state)
        self.histories = Histories(engine, written)
        kept, moves = self.histories.kept, not is_static(self.deck)
        self.resampling = Resampling(
            engine, kept, moves, lambda time, is_stored: self.recorder.take(time, is_stored)
        )
        self.pictures = Pictures(engine, self.deck)
        is_free = self.deck.output.states.interval is None and not is_static(self.deck)
        self.events = EventStates(engine, self.schedule, is_free, self.pictures.fields)

    def _open(self, resumed: float | None) -> None:
        """Evaluate the initial state, unless a dump brought another; open the files."""
        cpu = cpu_time()
        if resumed is None:
            if is_static(self.deck):
                self.heartbeat.does("searching the equilibrium in which the run begins")
            self.engine.start()
            refuse_inconsistencies(self.deck, self.engine)
            self.overlapping = touching_at_start(self.engine)
            notes = (*self.engine.notes, *self.overlapping, *contacts_without_depth(self.engine))
            for text in (*notes, *remark_on_safety(self.deck, self.engine.model)):
                self.log.line(text)
        self.cpu["compile or load"] += cpu_time() - cpu
        families, blocks = self.histories.families, self.pictures.blocks
        self.log.line(f"output: {expected_size(self.deck, families, blocks, self.folder)}")
        metadata = provenance(self.deck, self.engine)
        self.history = HistoryWriter(
            self.folder / "history.h5",
            self.histories.families,
            metadata,
            resumed,
            expected_rows=self.schedule.number(self.schedule.end) + 1,
            may_have_more=self.resampling.watches,
        )
        self.files.callback(lambda: write_peaks(self.folder / "peaks.txt", self.history.extremes))
        self.recorder = Recorder(self.histories, self.history)
        self.files.callback(self.recorder.close)
        described = metadata | self.pictures.description()
        self.states = StateWriter(self.folder, self.pictures.blocks, described, resumed)
        self.files.callback(self.states.close)
        # the checks of the start needed them
        self.engine.model.control["gaps"] = self.histories.needs_gaps
        self.has_begun = True
        if resumed is None:
            self.engine.sample()
            self.recorder.take(self.deck.control.start_time)
            self.write(self.deck.control.start_time, force=True)

    def _prepare_estimates(self, dump: Dump | None) -> None:
        """Look up the watched channels, and the step an accuracy needs.

        Raises DeckErrors, SolverError, RunStopped.
        """
        control, asks = self.deck.control, self.deck.watch or self.deck.expect
        # who only expects an equilibrium does not pay for one more
        is_enough = control.follows_path or (is_static(self.deck) and not self.deck.watch)
        self.is_estimated = bool(asks) and control.estimate != "off" and not is_enough
        if self.is_estimated and control.accuracy is not None:
            is_known = dump is not None and COARSENESS in dump[0]
            coarseness = float(dump[0][COARSENESS][0]) if dump and is_known else None
            self.heartbeat.does("pilot runs for the accuracy")
            self._begin_estimates().set_steps(self.engine.model.control, coarseness)
        elif asks or self.deck.output.report:
            # a misspelt channel is reported before the run, not after it
            from crashsolve.recording.questions import look_up

            look_up(self.deck, self.histories.families)

    def _begin_estimates(self) -> Estimating:
        """Estimates of the errors of the run. Raises DeckErrors."""
        # a run imports this when it needs it: at its end, but for an accuracy
        started = time.process_time()
        from crashsolve.estimate.runner import Estimating

        families, prepared = self.histories.families, self.prepared
        estimating = Estimating(self.deck, families, self._is_to_stop, self.log, prepared)
        self.estimating = self.account.estimating = estimating
        estimating.cpu += time.process_time() - started
        return estimating

    def _misses_its_accuracy(self) -> bool:
        """Estimate the errors of the finished run; whether another with other steps is due."""
        if not self.is_estimated:
            return False
        self.files.close()
        self.account.status("running", None, "estimating errors")
        self.heartbeat.does("estimating errors")
        from crashsolve.simulation.missed import missed_contacts, missed_curves
        from crashsolve.simulation.missed_motions import missed_motions

        estimating = self.estimating or self._begin_estimates()
        cycles, cpu = int(self.engine.clock["cycle"]), self.account.cpu_seconds()
        history, model = self.folder / "history.h5", self.engine.model
        mass = dict(zip(model.bodies, model.mass.tolist(), strict=False))
        missed, curves = missed_contacts(self.engine, history), missed_curves(self.engine, history)
        self.motions = missed_motions(self.engine, history, self.deck)
        return estimating.estimate(history, cycles, cpu, missed, mass, curves, self.motions)

    def _start_anew(self) -> None:
        """Run the deck again from its start, with the steps that the estimates ask for."""
        assert self.estimating is not None
        model, state = build(self.deck)
        self._use_engine(prepared_engine(self.deck, model, state, self.prepared)[0])
        self.account.phases, self.has_begun = None, False
        self.estimating.set_control(self.engine.model.control)
        self.cpu |= {"steps": 0.0, "output": 0.0}
        clear_folder(self.folder)
        self._open(None)

    def _is_to_stop(self) -> bool:
        self.requests.read()
        return "stop" in self.requests.words

    def write(self, now: float, force: bool) -> None:
        """Write the outputs that are due at this sample."""
        if force or self._due(now, self.state_step):
            self.states.write(now, self.pictures.fields())
            self.events.state_written()
        if force or self._due(now, self.log_step):
            self.account.progress()
        if self.restart_step and self._due(now, self.restart_step):
            self._dump()

    def _due(self, now: float, step: float) -> bool:
        """Whether a multiple of `step` has come since the last sample."""
        return self.passed(now, step) > self.passed(self.sampled, step)

    def passed(self, time: float, step: float) -> float:
        """Number of multiples of `step` from the start of the run to a time."""
        return float(np.floor((time - self.deck.control.start_time) / step + 1e-9))

    def _end(self, state: RunState, code: ExitCode, message: str) -> None:
        """Close the files, and write status, totals and the last line."""
        self.heartbeat.does("ending the run")
        self.files.close()
        # a run imports this at its end, when it needs it
        from crashsolve.simulation.ending import Ending

        texts = [*self.overlapping]
        # a run that is stopped during its pilot runs has no results
        if self.has_begun:
            interval, motions = self.schedule.interval, self.motions
            ending = Ending(self.engine, self.deck, self.folder, interval, motions)
            self.account.remarks = ending.remarks(self.history.extremes)
            texts += ending.warnings()
        self.account.status(state, code, message)
        for text in texts:
            self.log.warning(text)
        write_totals(self.account)
        self.log.finish(NORMAL if code == ExitCode.NORMAL else STOPPED)

    def _dump(self) -> None:
        self.recorder.flush()
        arrays = changing(self.engine) | self.histories.memory | self.resampling.memory()
        if self.estimating is not None:
            arrays[COARSENESS] = np.array([self.estimating.coarseness])
        path = write_restart(self.folder, arrays, {"deck_text": self.deck.text})
        self.log.line(f"restart dump {path.name} at t = {float(self.engine.clock['time']):.6g} s")

    def _restore(self, arrays: dict[str, np.ndarray], info: Json) -> float:
        """Read a dump; returns its time. Raises DeckError for the dump of another run."""
        differ = differing(str(info.get("deck_text")), self.deck.text)
        if any(is_bound for _, is_bound in differ):
            names = ", ".join(name for name, is_bound in differ if is_bound)
            raise self._inconsistency(
                f"another deck, or other values of --set; they differ in {names}"
            )
        try:
            restore(self.engine, arrays)
            for name, array in self.histories.memory.items():
                array[...] = arrays[name]
            self.resampling.recall(arrays)
        except (KeyError, ValueError, TypeError, IndexError) as reason:
            raise self._inconsistency("another version of crashsolve") from reason
        clock, end = self.engine.clock, self.schedule.end
        if end < float(clock["time"]):
            message = (
                f"control.end_time: {end:g} s lies before the dump, {float(clock['time']):.6g} s"
            )
            raise DeckError(str(self.deck.path), None, None, "", message, "give a later time")
        if differ:
            c = self.engine.model.control[0]
            clock["next_step"] = c["fixed_step"] or min(clock["next_step"], float(c["step_max"]))
        if self.deck.control.estimate != "off" and any(name in OF_ERRORS for name, _ in differ):
            self.log.warning(
                "the run used other settings before this restart; errors of watched channels are "
                "estimated as if all of it had used the present ones"
            )
        now = float(clock["sampled"])
        others = ", with other " + ", ".join(name for name, _ in differ) if differ else ""
        self.log.line(f"continuing from t = {now:.6g} s{others}")
        return now

    def _inconsistency(self, owner: str) -> DeckError:
        message = f"the dump in {self.folder} belongs to {owner}"
        advice = f"run without --restart, or into another folder; a restart may change {FREE}"
        return DeckError(str(self.deck.path), None, None, "", message, advice)

    def handle_requests(self) -> None:
        """Act on signals and on control.txt."""
        self.requests.read()
        if "states" in self.requests.words:
            self.states.write(float(self.engine.clock["sampled"]), self.pictures.fields())
            self.requests.words.discard("states")
        self._dump_or_stop()

    def _handle_requests_at_once(self) -> None:
        """Act on requests between two samples; those for pictures wait for the next sample."""
        self.account.keep_alive()
        self.requests.read()
        if "states" not in self.requests.words:
            self._dump_or_stop()

    def _stop_at_once(self) -> None:
        """Stop on request without a dump. Raises RunStopped."""
        if self._is_to_stop():
            began = "; continue with --restart" if self.has_begun else " before the run began"
            raise RunStopped(f"stopped on request{began}")

    def _dump_or_stop(self) -> None:
        if self.requests.words & {"stop", "dump"}:
            self._dump()
            self.requests.words.discard("dump")
        if "stop" in self.requests.words:
            now = float(self.engine.clock["time"])
            raise RunStopped(f"stopped on request at t = {now:.6g} s; continue with --restart")
