"""Reports of a run: its banner, lines of progress, and status.json."""

import os
import platform
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import llvmlite
import numpy as np

import crashsolve
from crashsolve.deck.dump import as_data
from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import ExitCode
from crashsolve.foundation.streams import report_error
from crashsolve.model.ledger import IMBALANCE, KINETIC, LARGEST
from crashsolve.output.files import Json
from crashsolve.output.log import ERROR, STOPPED, Log
from crashsolve.output.status import State as RunState
from crashsolve.output.status import Status, write_status
from crashsolve.recording.sampling import Schedule
from crashsolve.simulation.heartbeat import Heartbeat
from crashsolve.simulation.phases import ContactPhases
from crashsolve.simulation.remarks import StepWatch
from crashsolve.system.bounds import StepBound
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from crashsolve.estimate.runner import Estimating


# CPU time of no other stage
REST = "files and reports"


def cpu_time() -> float:
    """CPU time of this process and of the one that compiled for it [s]."""
    # os.times() counts in hundredths of a second, and a short run is over within one
    return time.process_time() + sum(os.times()[2:4])


@contextmanager
def preparing(deck: Deck, folder: Path, heartbeat: Heartbeat, append: bool) -> Iterator[Log]:
    """The log of a run; log and status.json report its preparation and how it ended.

    From here on status.json speaks of this run, and not of one before it. Raises OutputError.
    """
    start, end = deck.control.start_time, deck.control.last_time
    status = Status("running", start, 0, end, 0.0, 0.0, 0.0, 0.0, message="preparing")
    path, started = folder / "status.json", time.monotonic()
    write_status(path, status)
    log: Log | None = None

    def print_line(text: str) -> None:
        if log is not None:
            log.line(text)
        if status.state != "running":
            return
        status.cpu, status.wall, status.message = cpu_time(), time.monotonic() - started, text
        write_status(path, status)

    heartbeat.print_line = print_line
    try:
        log = Log(folder / "log.txt", append=append)
        yield log
    except BaseException as error:
        is_requested = isinstance(error, KeyboardInterrupt)
        status.state = "stopped" if is_requested else "failed"
        code = getattr(error, "exit_code", ExitCode.INTERNAL)
        status.exit_code = int(ExitCode.STOPPED if is_requested else code)
        status.message = (
            "interrupted while preparing" if is_requested else str(error) or repr(error)
        )
        write_status(path, status)
        if log is None and is_requested:
            # the signal came while log.txt was being opened
            log = Log(folder / "log.txt", append=append)
        if log is not None:
            (log.line if is_requested else log.error)(status.message)
            log.finish(STOPPED if is_requested else ERROR)
        raise


class Account:
    """The account of one run; `cpu` [s] is by stage, `phases` and `estimating` come in later."""

    def __init__(
        self,
        deck: Deck,
        engine: Engine,
        folder: Path,
        log: Log,
        cpu: dict[str, float],
        wall_begun: float,
        heartbeat: Heartbeat,
    ) -> None:
        self.deck, self.engine, self.folder, self.log = deck, engine, folder, log
        self.cpu, self.wall_begun = cpu, wall_begun
        self.heartbeat, self.pace, self.steps = heartbeat, Pace(), StepWatch()
        # remarks that are known at the end
        self.remarks: Json = {}
        self.bound = ""
        self._bounds = StepBound(Schedule.of(deck).interval, deck.control.step_max)
        # a thread may write lines of the run as well
        self._writing = threading.RLock()
        self._has_ended = False
        self.phases: ContactPhases | None = None
        self.estimating: Estimating | None = None

    def banner(self) -> None:
        """The program and the model, at the head of the log."""
        model = self.engine.model
        counts = {k: len(v) for k, v in self.deck.entries.items() if v}
        threads = {"threads": str(model.threads)} if model.threads > 1 else {}
        self.log.banner(
            f"crashsolve {crashsolve.__version__}",
            {
                "deck": str(self.deck.path),
                "title": self.deck.title,
                "host": os.uname().nodename,
                "model": ", ".join(f"{k} {n}" for k, n in counts.items()) or "empty",
                "mass": f"{model.total_mass():.6g} kg",
                "size": f"{model.size:.4g} m",
                "integrator": ": ".join(filter(None, (model.integrator, model.choice))),
                **threads,
            },
        )

    def progress(self) -> None:
        """A line of the log, status.json, and the bar on a terminal."""
        e, clock = self.engine, self.engine.clock
        self.pace.update(float(clock["time"]), self.deck.control.last_time)
        self.log.cycle(
            int(clock["cycle"]),
            float(clock["time"]),
            float(clock["step"]),
            float(newest_ledger(e)[KINETIC]),
            balance(e),
            float(clock["residual"]),
            self.pace.left,
            self.step_bound(),
        )
        self.heartbeat.reported()
        self.status("running", None, "")
        span = self.deck.control.last_time - self.deck.control.start_time
        self.log.progress((clock["time"] - self.deck.control.start_time) / (span or 1.0))

    def keep_alive(self) -> None:
        """Check the step; print a line where none has come for long. Raises OutputError."""
        # a record array's own look-up of a column takes as long as a step of a small scene
        clock = self.engine.state.clock[0]
        fallen = self.steps.warning(float(clock["time"]), int(clock["cycle"]))
        if fallen:
            self.log.warning(f"{fallen}; it is set by: {self.step_bound()}")
        if self.heartbeat.is_due():
            self.progress()

    def print_line(self, text: str) -> None:
        """Write the present long activity to the log and status.json. Raises OutputError."""
        clock = self.engine.clock
        self.log.line(f"{text}, at t = {float(clock['time']):.6g} s, cycle {int(clock['cycle'])}")
        self.status("running", None, text)

    def step_bound(self) -> str:
        """The entity that limits the step, and why."""
        is_static = self.deck.control.solution == "quasi_static"
        self.bound = "load steps" if is_static else self._bounds.report(self.engine)
        return self.bound

    def status(self, state: RunState, code: ExitCode | None, message: str) -> None:
        """Renew status.json; once a run has ended it runs no more. Raises OutputError."""
        with self._writing:
            # a heartbeat may have waited for the end to be written
            if self._has_ended and state == "running":
                return
            self._has_ended = state != "running"
            self._write_status(state, code, message)

    def _write_status(self, state: RunState, code: ExitCode | None, message: str) -> None:
        clock = self.engine.clock
        write_status(
            self.folder / "status.json",
            Status(
                state,
                float(clock["time"]),
                int(clock["cycle"]),
                self.deck.control.last_time,
                float(clock["step"]),
                balance(self.engine),
                cpu_time(),
                time.monotonic() - self.wall_begun,
                None if code is None else int(code),
                message,
                cpu_steps=self.cpu["steps"],
                step_set_by=self.bound,
                left=self.pace.left if state == "running" else None,
                **self._results(),
            ),
        )

    def close_stages(self) -> None:
        """Count the time of no other stage: opening and closing of files, checks of results."""
        # last of all stages, also where an earlier status was written without some of them
        self.cpu.pop(REST, None)
        self.cpu[REST] = max(cpu_time() - sum(self.cpu.values()), 0.0)

    def cpu_seconds(self) -> float:
        """CPU time of the run proper: steps and output [s]."""
        return self.cpu["steps"] + self.cpu["output"]

    def _results(self) -> Json:
        """Steps, constraints, CPU time and watched channels so far, as status.json has them."""
        clock, results = self.engine.clock, Json()
        if self.phases is not None and self.phases.cycles():
            results |= {
                "average_step": self.phases.averages(),
                "real_time_factor": self.cpu_seconds() / self.phases.simulated(),
            }
        if self.estimating is not None:
            self.cpu["estimates"] = self.estimating.cpu
            results["watched"] = self.estimating.entries()
        self.close_stages()
        return (
            results
            | self.remarks
            | {
                "rejected": int(clock["rejected"]),
                "constraint_position": float(clock["residual"]),
                "constraint_velocity": float(clock["rate_residual"]),
                "cpu_stages": dict(self.cpu),
            }
        )


def end_at_once(log: Log, account: Account) -> None:
    """End the process without a restart dump: at any moment all files are whole."""
    text = "interrupted twice: ended at once, without a restart dump"
    for act in (
        lambda: log.last_words(text),
        lambda: account.status("stopped", ExitCode.STOPPED, text),
        lambda: report_error(text),
    ):
        # an interrupt at any place
        with suppress(Exception):
            act()
    os._exit(ExitCode.STOPPED)


class Pace:
    """Wall time a run still needs, by its pace since the last line but a second ago."""

    def __init__(self) -> None:
        self.left: float | None = None
        self._mark: tuple[float, float] | None = None

    def update(self, now: float, end: float) -> None:
        """Take note of the time simulated [s]."""
        wall = time.monotonic()
        if self._mark is None or now < self._mark[1]:
            self._mark = wall, now
        elif wall > self._mark[0] and now > self._mark[1]:
            self.left = (end - now) / (now - self._mark[1]) * (wall - self._mark[0])
            if wall > self._mark[0] + 1.0:
                self._mark = wall, now


def newest_ledger(engine: Engine) -> np.ndarray:
    """Energies of the last sample, or of a later look of the guard in the compiled loop."""
    since = int(engine.clock["cycle"]) - int(engine.sampled["cycle"])
    is_old = since >= int(engine.model.control[0]["check_every"])
    return engine.state.ledger if is_old else engine.ledger


def balance(engine: Engine) -> float:
    """Energy that is missing or too much, in % of the largest energy."""
    ledger = newest_ledger(engine)
    return float(100.0 * ledger[IMBALANCE] / ledger[LARGEST]) if ledger[LARGEST] > 0 else 0.0


def provenance(deck: Deck, engine: Engine) -> Json:
    """The provenance of results: deck, versions, host, as result files keep it."""
    report = deck.output.report
    return {
        "title": deck.title,
        "deck_name": deck.path.name,
        "deck_text": deck.text,
        "deck_sources": {path.name: path.read_text("utf-8") for path in deck.files},
        "parameters": deck.parameters,
        "derived_parameters": deck.derived,
        "parameters_with_units": deck.with_units,
        "expect": deck.expectations(),
        "report": as_data(report) if report is not None else None,
        "channels": deck.output.history.channels,
        "citations": engine.model.citations,
        "versions": {
            "crashsolve": crashsolve.__version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "llvmlite": llvmlite.__version__,
            "h5py": h5py.__version__,
        },
        "host": os.uname().nodename,
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
    }
