"""One run: deck to results. The recital of the roof: read, build, compose, advance, write.

Signals: SIGTERM and SIGINT dump and stop, SIGUSR1 dumps and goes on, SIGCONT is ignored (queues
send it along). The words stop, dump and states in control.txt of the results folder do the same.
"""

import os
import platform
import signal
import socket
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import crashsolve
from crashsolve.deck.dump import as_data
from crashsolve.deck.read import Deck, read_deck
from crashsolve.foundation.errors import (
    CrashsolveError,
    DeckError,
    DeckErrors,
    ExitCode,
    RunStopped,
)
from crashsolve.histories import Histories
from crashsolve.model.build import build
from crashsolve.model.ledger import ENTRIES, IMBALANCE, KINETIC, LARGEST
from crashsolve.output.errors import OutputError
from crashsolve.output.files import reported
from crashsolve.output.history import HistoryWriter
from crashsolve.output.log import Log
from crashsolve.output.peaks import write_peaks
from crashsolve.output.restart import SLOTS, newest_restart, write_restart
from crashsolve.output.states import StateWriter
from crashsolve.output.status import State as RunState
from crashsolve.output.status import Status, write_status
from crashsolve.phases import ContactPhases
from crashsolve.pictures import Pictures
from crashsolve.resume import changing, restore
from crashsolve.sampling import Schedule
from crashsolve.system.engine import Engine

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
    deck = read_deck(deck_path, overrides)
    was_read = cpu_time()
    model, state = build(deck)
    # runs beside this one must not choose anew
    control = deck.control.model_copy(update={"integrator": model.integrator})
    deck = replace(deck, control=control)
    with reported(folder):
        folder.mkdir(parents=True, exist_ok=True)
    built = cpu_time()
    engine = Engine(model, state)
    spent = {"read": was_read - begun, "build": built - was_read}
    spent |= {"compile or load": cpu_time() - built, "steps": 0.0, "output": 0.0}
    return Run(deck, engine, folder, spent, wall_begun).execute(restart)


def cpu_time() -> float:
    """CPU time of this process and of the one that compiled for it [s]."""
    # os.times() counts in hundredths of a second, and a short run is over within one
    return time.process_time() + sum(os.times()[2:4])


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
        try:
            self._banner()
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
            lambda: self._status("failed", code, message),
            self._summary,
            lambda: self.log.finish(normal=False),
        ):
            with suppress(OutputError):
                act()

    def _begin(self, dump: Any) -> None:
        """Take up the dump, if any; prepare the estimates; open the files."""
        # both measure from the start of the run, whatever a dump brings
        self.histories, self.pictures = Histories(self.engine), Pictures(self.engine)
        resumed = None if dump is None else self._restore(*dump)
        self.estimating = self._prepare_estimates(dump)
        self._open(resumed)

    def _open(self, resumed: float | None) -> None:
        """Evaluate the initial state, unless a dump brought another; open the files."""
        cpu = cpu_time()
        if resumed is None:
            self.engine.start()
            self._refuse_misfits()
        self.cpu["compile or load"] += cpu_time() - cpu
        metadata = self._metadata()
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
        if self.deck.control.estimate == "off" or not (self.deck.watch or self.deck.expect):
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
        self._status("running", None, "estimating errors")
        cycles = int(self.engine.clock["cycle"])
        return self.estimating.judge(self.folder / "history.h5", cycles, self._spent())

    def _start_anew(self) -> None:
        """The same deck from its start, with the steps that the estimates ask for."""
        assert self.estimating is not None
        self.engine = Engine(*build(self.deck))
        self.histories, self.pictures = Histories(self.engine), Pictures(self.engine)
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
        self.phases = ContactPhases(self.engine)
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
            self.phases.count()
            self._write(target, force=target == end)
            self._obey()
            self.cpu["output"] += time.process_time() - advanced

    def _write(self, now: float, force: bool) -> None:
        """Whatever is due at this sample."""
        self.history.append(now, self.histories.row())
        if force or self._due(now, self.state_step):
            self.states.write(now, self.pictures.fields())
        if force or self._due(now, self.log_step):
            self._log_line()
        if self.restart_step and self._due(now, self.restart_step):
            self._dump()

    def _due(self, now: float, step: float) -> bool:
        """Whether a multiple of `step` lies in the last history interval."""
        begun = now - self.deck.control.start_time
        before = begun - self.history_step
        return int(begun / step + 1e-9) > int(before / step + 1e-9)

    def _log_line(self) -> None:
        e, clock = self.engine, self.engine.clock
        limiter = "samples, tolerance or deck" if len(e.state.stages) else "samples, turn or deck"
        limiter = e.limiter() or limiter
        self.log.cycle(
            int(clock["cycle"]),
            float(clock["time"]),
            float(clock["step"]),
            float(e.ledger[KINETIC]),
            self._balance(),
            float(clock["residual"]),
            limiter,
        )
        self._status("running", None, "")
        span = self.deck.control.end_time - self.deck.control.start_time
        self.log.progress((clock["time"] - self.deck.control.start_time) / (span or 1.0))

    def _balance(self) -> float:
        ledger = self.engine.ledger
        return float(100.0 * ledger[IMBALANCE] / ledger[LARGEST]) if ledger[LARGEST] > 0 else 0.0

    def _status(self, state: RunState, code: ExitCode | None, message: str) -> None:
        clock = self.engine.clock
        write_status(
            self.folder / "status.json",
            Status(
                state,
                float(clock["time"]),
                int(clock["cycle"]),
                self.deck.control.end_time,
                float(clock["step"]),
                self._balance(),
                cpu_time(),
                time.monotonic() - self.wall_begun,
                None if code is None else int(code),
                message,
                cpu_steps=self.cpu["steps"],
                **self._results(),
            ),
        )

    def _results(self) -> dict[str, Any]:
        """What status.json tells of steps, constraints, CPU time and watched channels so far."""
        clock, found = self.engine.clock, dict[str, Any]()
        if hasattr(self, "phases") and self.phases.cycles():
            found |= {
                "average_step": self.phases.averages(),
                "real_time_factor": self._spent() / self.phases.simulated(),
            }
        if self.estimating is not None:
            self.cpu["estimates"] = self.estimating.cpu
            found["watched"] = self.estimating.entries()
        return found | {
            "rejected": int(clock["rejected"]),
            "constraint_position": float(clock["residual"]),
            "constraint_velocity": float(clock["rate_residual"]),
            "cpu_stages": dict(self.cpu),
        }

    def _spent(self) -> float:
        """CPU time of the run proper: steps and output [s]."""
        return self.cpu["steps"] + self.cpu["output"]

    def _end(self, state: RunState, code: ExitCode, message: str) -> None:
        """Close the files, and write status, totals and the last line."""
        self.files.close()
        self._status(state, code, message)
        for text in (*self.engine.law_warnings(), *self.engine.step_warnings()):
            self.log.warning(text)
        self._summary()
        self.log.finish(normal=code == ExitCode.NORMAL)

    def _summary(self) -> None:
        clock = self.engine.clock
        saddle = self.engine.model.saddle
        facts = {
            "steps accepted, rejected": f"{int(clock['cycle'])}, {int(clock['rejected'])}",
            "onsets located": f"{int(clock['located'])}",
            "energy balance": f"{self._balance():.3g} %",
        }
        if self.engine.model.joints:
            facts["constraint rows, redundant"] = f"{saddle.rows()}, {saddle.redundant()}"
            facts["iterations per step"] = (
                f"{clock['iterations'] / max(int(clock['cycle']), 1):.2f}"
            )
            facts["largest constraint error, in position and velocity"] = (
                f"{float(clock['residual']):.2g} and {float(clock['rate_residual']):.2g} 1/s, "
                "of the model's size"
            )
        self.log.line()
        self.log.facts(facts | self._cost())
        self._energies()
        self.log.timing(self.cpu)
        self.log.citations(self.engine.model.citations)

    def _cost(self) -> dict[str, str]:
        """Average steps and what they cost; nothing of a run that took none."""
        if not hasattr(self, "phases") or not self.phases.cycles():
            return {}
        simulated = self.phases.simulated()
        return self.phases.average_steps() | {
            "CPU per step": f"{1e6 * self.cpu['steps'] / self.phases.cycles():.3g} us",
            "real-time factor": f"{self._spent() / simulated:.3g} s of CPU per simulated second",
        }

    def _energies(self) -> None:
        """The ledger at the end, in J and in % of the largest energy."""
        ledger = self.engine.ledger
        largest = float(ledger[LARGEST]) or 1.0
        lines = [
            f"{name.replace('_', ' '):20} {value:14.6e} J {100 * value / largest:9.3f} %"
            for name, value in zip(ENTRIES, map(float, ledger), strict=True)
            if value != 0.0
        ]
        self.log.section("energy", lines)

    def _banner(self) -> None:
        model = self.engine.model
        counts = {k: len(v) for k, v in self.deck.entries.items() if v}
        self.log.banner(
            f"crashsolve {crashsolve.__version__}",
            {
                "deck": str(self.deck.path),
                "title": self.deck.title,
                "host": socket.gethostname(),
                "model": ", ".join(f"{n} {k}" for k, n in counts.items()) or "empty",
                "mass": f"{model.total_mass():.6g} kg",
                "size": f"{model.size:.4g} m",
                "integrator": ": ".join(filter(None, (model.integrator, model.choice))),
            },
        )

    def _metadata(self) -> dict[str, Any]:
        report = self.deck.output.report
        return {
            "title": self.deck.title,
            "deck_name": self.deck.path.name,
            "deck_text": self.deck.text,
            "deck_sources": {path.name: path.read_text("utf-8") for path in self.deck.files},
            "parameters": self.deck.parameters,
            "expect": self.deck.expectations(),
            "report": as_data(report) if report is not None else None,
            "citations": self.engine.model.citations,
            "versions": {
                "crashsolve": crashsolve.__version__,
                "python": platform.python_version(),
                "numpy": np.__version__,
                "numba": version("numba"),
                "h5py": version("h5py"),
            },
            "host": socket.gethostname(),
            "started": datetime.now(UTC).isoformat(timespec="seconds"),
        }

    def _dump(self) -> None:
        self.history.flush()
        arrays = changing(self.engine) | self.histories.memory
        if self.estimating is not None:
            arrays[COARSENESS] = np.array([self.estimating.coarseness])
        path = write_restart(self.folder, arrays, {"deck_text": self.deck.text})
        self.log.line(
            f"restart dump {path.name} at t = {float(self.engine.clock['sampled']):.6g} s"
        )

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
        if self.requests & {"stop", "dump"}:
            self._dump()
        if "stop" in self.requests:
            now = float(self.engine.clock["sampled"])
            raise RunStopped(f"stopped on request at t = {now:.6g} s; go on with --restart")
        self.requests.clear()

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
