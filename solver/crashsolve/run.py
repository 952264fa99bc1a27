"""One run: deck to results. The recital of the roof: read, build, compose, advance, write.

Signals: SIGTERM and SIGINT dump and stop, SIGUSR1 dumps and goes on, SIGCONT is ignored (queues
send it along). The words stop, dump and states in control.txt of the results folder do the same.
"""

import signal
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crashsolve.account import Account, cpu_time, provenance
from crashsolve.deck.read import Deck, read_deck
from crashsolve.foundation.errors import (
    CrashsolveError,
    DeckError,
    DeckErrors,
    ExitCode,
    RunStopped,
)
from crashsolve.foundation.machine import forget_linker
from crashsolve.histories import Histories
from crashsolve.model.build import build
from crashsolve.model.model import Model, State
from crashsolve.model.statics import goes_by_steps
from crashsolve.output.errors import OutputError
from crashsolve.output.files import reported
from crashsolve.output.history import HistoryWriter
from crashsolve.output.log import Log
from crashsolve.output.peaks import write_peaks
from crashsolve.output.restart import SLOTS, newest_restart, write_restart
from crashsolve.output.states import StateWriter
from crashsolve.output.status import State as RunState
from crashsolve.phases import ContactPhases
from crashsolve.pictures import Pictures
from crashsolve.resume import changing, restore
from crashsolve.sampling import Schedule
from crashsolve.system.contact_balance import contact_warnings
from crashsolve.system.engine import Engine
from crashsolve.totals import write_totals

if TYPE_CHECKING:
    from crashsolve.estimate.conduct import Estimating

# what a user may ask of a run, by control.txt and by signals
WORDS = {"stop", "dump", "states"}
# of the steps that an accuracy needs, in a restart dump
COARSENESS = "run/coarseness"
SIGNALS: dict[int, str] = {signal.SIGTERM: "stop", signal.SIGINT: "stop", signal.SIGUSR1: "dump"}


def solve(deck_path: Path, folder: Path, overrides: Mapping[str, str], restart: bool) -> int:
    """Run a deck and write its results; returns the exit code. Raises CrashsolveError."""
    begun, wall_begun = cpu_time(), time.monotonic()
    # before the arrays of a large model come
    forget_linker()
    deck = read_deck(deck_path, overrides)
    was_read = cpu_time()
    model, state = build(deck)
    # runs beside this one must not choose anew
    control = deck.control.model_copy(update={"integrator": model.integrator})
    deck = replace(deck, control=control)
    with reported(folder):
        folder.mkdir(parents=True, exist_ok=True)
    built = cpu_time()
    engine = _engine(deck, model, state)
    spent = {"read": was_read - begun, "build": built - was_read}
    spent |= {"compile or load": cpu_time() - built, "steps": 0.0, "output": 0.0}
    return Run(deck, engine, folder, spent, wall_begun).execute(restart)


def _engine(deck: Deck, model: Model, state: State) -> Engine:
    """What goes from sample to sample: through time, or from equilibrium to equilibrium."""
    if deck.control.solution == "transient":
        return Engine(model, state)
    from crashsolve.system.equilibrium import StaticEngine

    if goes_by_steps(model.groups):
        from crashsolve.system.rest import RestEngine

        return RestEngine(model, state, deck.control.tolerance)
    return StaticEngine(model, state, deck.control.tolerance)


class Run:
    """A deck being solved into a results folder."""

    def __init__(
        self,
        deck: Deck,
        engine: Engine,
        folder: Path,
        spent: dict[str, float],
        wall_begun: float,
    ) -> None:
        self.deck, self.engine, self.folder = deck, engine, folder
        self.cpu, self.wall_begun = spent, wall_begun
        self.requests: set[str] = set()
        self.files = ExitStack()
        self.estimating: Estimating | None = None
        self.schedule = Schedule.of(deck)
        self.history_step = self.schedule.interval
        span, out = self.schedule.end - self.schedule.start, deck.output
        self.state_step = out.states.interval or span / 50 or 1.0
        self.log_step = out.log.interval or span / 20 or 1.0
        self.restart_step = out.restart.every

    def execute(self, restart: bool) -> int:
        """The whole run. Raises SolverError, RunStopped, OutputError after flushing."""
        self._catch_signals()
        notes: list[str] = []
        dump = newest_restart(self.folder, notes.append) if restart else None
        if not restart:
            self._clear_folder()
        elif dump is None:
            notes.append("no restart dump in the folder: the run begins anew")
        if self.state_step < self.history_step:
            notes.append(f"states are written with the samples, {self.history_step:.3g} s apart")
        self.log = Log(self.folder / "log.txt", append=dump is not None)
        self.account = Account(
            self.deck, self.engine, self.folder, self.log, self.cpu, self.wall_begun
        )
        try:
            self.account.banner()
            for text in (*notes, *self.engine.model.warnings):
                self.log.warning(text)
            self._begin(dump)
            self._march()
            self.engine.finish()
            while self._misses_its_accuracy():
                self._start_anew()
                self._march()
                self.engine.finish()
            self._end("finished", ExitCode.NORMAL, "")
            return ExitCode.NORMAL
        except RunStopped as stop:
            self.log.line(str(stop))
            self._end("stopped", ExitCode.STOPPED, str(stop))
            raise
        except Exception as error:
            self._fail(error)
            raise

    def _clear_folder(self) -> None:
        """Remove what an earlier run left that this one could mistake for its own."""
        with reported(self.folder):
            for name in (*SLOTS, "control.txt", "peaks.txt"):
                (self.folder / name).unlink(missing_ok=True)

    def _fail(self, error: Exception) -> None:
        """Tell the error and save what can be saved; the first error is the one that counts."""
        code, message = ExitCode.INTERNAL, f"internal: {error!r}"
        if isinstance(error, CrashsolveError):
            code, message = ExitCode(error.exit_code), str(error)
        for act in (
            lambda: self.log.error(message),
            self.files.close,
            lambda: self.account.status("failed", code, message),
            lambda: write_totals(self.account),
            lambda: self.log.finish(normal=False),
        ):
            with suppress(OutputError):
                act()

    def _begin(self, dump: Any) -> None:
        """Take up the dump, if any; prepare the estimates; open the files."""
        # both measure from the start of the run, whatever a dump brings
        self._take_up(self.engine)
        resumed = None if dump is None else self._restore(*dump)
        self.estimating = self.account.estimating = self._prepare_estimates(dump)
        self._open(resumed)

    def _take_up(self, engine: Engine) -> None:
        """Make this engine the run's: what is told, written and obeyed is of it."""
        self.engine = self.account.engine = engine
        engine.on_pause = self._obey_at_once
        self.histories, self.pictures = Histories(engine), Pictures(engine)

    def _open(self, resumed: float | None) -> None:
        """Evaluate the initial state, unless a dump brought another; open the files."""
        cpu = cpu_time()
        if resumed is None:
            self.engine.start()
            self._refuse_misfits()
        self.cpu["compile or load"] += cpu_time() - cpu
        metadata = provenance(self.deck, self.engine)
        self.history = HistoryWriter(
            self.folder / "history.h5", self.histories.families, metadata, resumed
        )
        self.files.callback(lambda: write_peaks(self.folder / "peaks.txt", self.history.extremes))
        self.files.callback(self.history.close)
        self.states = StateWriter(self.folder, self.pictures.blocks, metadata, resumed)
        self.files.callback(self.states.close)
        if resumed is None:
            self.engine.sample()
            self._write(self.deck.control.start_time, force=True)

    def _prepare_estimates(self, dump: Any) -> "Estimating | None":
        """Look up the watched channels, and the step an accuracy needs; None without any.

        Raises DeckErrors, SolverError, RunStopped.
        """
        control = self.deck.control
        if control.estimate == "off" or not (self.deck.watch or self.deck.expect):
            return None
        if control.solution == "quasi_static":
            # an equilibrium has no error of steps
            return None
        # a deck that watches nothing does not pay for what this imports
        from crashsolve.estimate.conduct import Estimating

        families = self.histories.families
        estimating = Estimating(self.deck, families, self._is_to_stop, self.log)
        coarseness = float(dump[0][COARSENESS][0]) if dump else None
        estimating.set_steps(self.engine.model.control, coarseness)
        return estimating

    def _misses_its_accuracy(self) -> bool:
        """Estimate the errors of the finished run; whether another with other steps is due."""
        if self.estimating is None:
            return False
        self.files.close()
        self.account.status("running", None, "estimating errors")
        cycles = int(self.engine.clock["cycle"])
        return self.estimating.judge(self.folder / "history.h5", cycles, self.account.spent())

    def _start_anew(self) -> None:
        """The same deck from its start, with the steps that the estimates ask for."""
        assert self.estimating is not None
        self._take_up(Engine(*build(self.deck)))
        self.account.phases = None
        self.estimating.set_control(self.engine.model.control)
        self.cpu |= {"steps": 0.0, "output": 0.0}
        self._clear_folder()
        self._open(None)

    def _is_to_stop(self) -> bool:
        self._read_control()
        return "stop" in self.requests

    def _refuse_misfits(self) -> None:
        found = [
            self.deck.error(self.deck.entries[word][name], None, text, advice)
            for word, wrong, advice in (
                ("joints", self.engine.assembly_errors(), "correct the joint or the bodies"),
                ("contacts", self.engine.overlaps(), "move the bodies apart"),
            )
            for name, text in wrong
        ]
        if found:
            raise DeckErrors(found)

    def _march(self) -> None:
        """Advance from sample to sample until the end."""
        end = self.schedule.end
        phases = self.account.phases = ContactPhases(self.engine)
        k = self.schedule.number(float(self.engine.clock["sampled"]))
        target = self.schedule.time(k)
        while target < end:
            k += 1
            target = self.schedule.time(k)
            # no run has children while it marches: their times need not be asked for
            begun = time.process_time()
            try:
                self.engine.reach(target)
            finally:
                advanced = time.process_time()
                self.cpu["steps"] += advanced - begun
            self.engine.sample(target)
            phases.count()
            self._write(target, force=target == end)
            self._obey()
            self.cpu["output"] += time.process_time() - advanced

    def _write(self, now: float, force: bool) -> None:
        """Whatever is due at this sample."""
        self.history.append(now, self.histories.row())
        if force or self._due(now, self.state_step):
            self.states.write(now, self.pictures.fields())
        if force or self._due(now, self.log_step):
            self.account.progress()
        if self.restart_step and self._due(now, self.restart_step):
            self._dump()

    def _due(self, now: float, step: float) -> bool:
        """Whether a multiple of `step` lies in the last history interval."""
        begun = now - self.deck.control.start_time
        before = begun - self.history_step
        return int(begun / step + 1e-9) > int(before / step + 1e-9)

    def _end(self, state: RunState, code: ExitCode, message: str) -> None:
        """Close the files, and write status, totals and the last line."""
        self.files.close()
        self.account.status(state, code, message)
        engine = self.engine
        unbalanced = []
        if self.deck.control.solution == "transient":
            unbalanced = contact_warnings(engine.model, engine.state, engine.ledger)
        for text in (*engine.law_warnings(), *unbalanced, *engine.step_warnings()):
            self.log.warning(text)
        write_totals(self.account)
        self.log.finish(normal=code == ExitCode.NORMAL)

    def _dump(self) -> None:
        self.history.flush()
        arrays = changing(self.engine) | self.histories.memory
        if self.estimating is not None:
            arrays[COARSENESS] = np.array([self.estimating.coarseness])
        path = write_restart(self.folder, arrays, {"deck_text": self.deck.text})
        self.log.line(f"restart dump {path.name} at t = {float(self.engine.clock['time']):.6g} s")

    def _restore(self, arrays: dict[str, np.ndarray], info: dict[str, Any]) -> float:
        """Take up a dump; returns its time. Raises DeckError for the dump of another run."""
        if info["deck_text"] != self.deck.text:
            raise self._misfit("another deck, or other values of --set")
        try:
            restore(self.engine, arrays)
            for name, array in self.histories.memory.items():
                array[...] = arrays[name]
        except (KeyError, ValueError) as reason:
            raise self._misfit("another version of crashsolve") from reason
        now = float(self.engine.clock["sampled"])
        self.log.line(f"going on from t = {now:.6g} s")
        return now

    def _misfit(self, owner: str) -> DeckError:
        message = f"the dump in {self.folder} belongs to {owner}"
        advice = "run without --restart, or into another folder"
        return DeckError(str(self.deck.path), None, None, "", message, advice)

    def _catch_signals(self) -> None:
        """Keep requests for the next pause; a second interrupt from the keyboard ends at once."""

        def keep(number: int, _: Any) -> None:
            self.requests.add(SIGNALS[number])
            if number == signal.SIGINT:
                signal.signal(number, signal.default_int_handler)

        for number in SIGNALS:
            signal.signal(number, keep)
        signal.signal(signal.SIGCONT, signal.SIG_IGN)

    def _obey(self) -> None:
        """Act on signals and on control.txt."""
        self._read_control()
        if "states" in self.requests:
            self.states.write(float(self.engine.clock["sampled"]), self.pictures.fields())
            self.requests.discard("states")
        self._dump_or_stop()

    def _obey_at_once(self) -> None:
        """The same between two samples; pictures, and what was asked with them, wait for one."""
        self._read_control()
        if "states" not in self.requests:
            self._dump_or_stop()

    def _dump_or_stop(self) -> None:
        if self.requests & {"stop", "dump"}:
            self._dump()
            self.requests.discard("dump")
        if "stop" in self.requests:
            now = float(self.engine.clock["time"])
            raise RunStopped(f"stopped on request at t = {now:.6g} s; go on with --restart")

    def _read_control(self) -> None:
        """Take up the words of control.txt and remove it."""
        path = self.folder / "control.txt"
        if not path.exists():
            return
        with reported(path):
            words = set(path.read_text("utf-8", errors="replace").split())
            path.unlink()
        self.requests |= words & WORDS
        for word in sorted(words - WORDS):
            self.log.warning(f"control.txt: unknown word '{word}' (words: dump, states, stop)")
