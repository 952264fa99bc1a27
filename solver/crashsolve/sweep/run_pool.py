"""The runs of a sweep side by side, each an ordinary run in a process of its own, on one display.

One loop looks at all of them, so that a signal to it reaches every run: SIGTERM and SIGINT stop
them with a dump each, SIGUSR1 dumps. A run that was stopped or killed continues from its dump.
"""

import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from crashsolve.foundation.errors import ExitCode
from crashsolve.foundation.streams import discard_output, print_line, printable
from crashsolve.output.files import reported
from crashsolve.output.lock import is_held
from crashsolve.study.child_runs import reason, start, status_of
from crashsolve.sweep.folder import ERRORS, Run, RunStatus, clear, record, run_status

# [s] between two looks at the runs, and between two lines where standard output is no terminal
POLL, LINE_INTERVAL = 0.05, 60.0
SHOWN = 4
STATES = {int(ExitCode.NORMAL): "finished", int(ExitCode.STOPPED): "stopped"}
Scene = Callable[[Run], tuple[str, ...]]


@dataclass
class Worker:
    """A run and its process; `is_stopping` once it has been asked to stop."""

    run: Run
    process: subprocess.Popen[str]
    started: float = field(default_factory=time.monotonic)
    is_compiled: bool = False
    is_stopping: bool = False
    progress: float = 0.0


@dataclass
class RunPool:
    """Runs a list of runs, `jobs` at a time, into the folder of their sweep.

    `scene` distinguishes the runs whose steps must be compiled: the first of each begins alone.
    `after_first` is called once the first run has finished.
    """

    deck: Path
    folder: Path
    jobs: int
    scene: Scene
    time_limit: float | None = None
    after_first: Callable[[], None] | None = None
    states: dict[int, RunStatus] = field(default_factory=dict)
    codes: dict[int, int] = field(default_factory=dict)
    requests: list[int] = field(default_factory=list)
    is_stopping: bool = False

    def run_all(self, runs: Sequence[Run]) -> None:
        """Run all; afterwards `states` and `codes` have the outcome of each. Raises OutputError."""
        waiting, workers = list(runs), list[Worker]()
        self._compiled: set[tuple[str, ...]] = set()
        self._held_by_others: set[int] = set()
        self._count, self._started = len(waiting), time.monotonic()
        self._last_line, self._ended = self._started, 0
        before = {n: signal.signal(n, self._receive_signal) for n in _SIGNALS}
        try:
            while waiting or workers:
                self._forward_signals(workers)
                if self.is_stopping:
                    waiting.clear()
                self._start_waiting(waiting, workers)
                for worker in [w for w in workers if w.process.poll() is not None]:
                    workers.remove(worker)
                    self._finish(worker)
                self._monitor(workers, len(waiting))
                time.sleep(POLL)
        finally:
            for worker in workers:
                worker.process.terminate()
            for number, handler in before.items():
                signal.signal(number, handler)
            self._clear_line()

    def _receive_signal(self, number: int, _: object) -> None:
        self.requests.append(number)

    def _forward_signals(self, workers: Sequence[Worker]) -> None:
        """Hand signals on to all runs."""
        while self.requests:
            number = self.requests.pop(0)
            for worker in workers:
                worker.process.send_signal(_SIGNALS[number])
            if number != signal.SIGUSR1:
                if not self.is_stopping:
                    self._print(f"stopping {len(workers)} runs, each with a dump")
                self.is_stopping = True
                for worker in workers:
                    worker.is_stopping = True

    def _start_waiting(self, waiting: list[Run], workers: list[Worker]) -> None:
        """Start the runs that may start now; a run that another process still holds waits for
        it.
        """
        for run in list(waiting):
            if len(workers) >= self.jobs:
                return
            scene = self.scene(run)
            is_first = scene not in [self.scene(w.run) for w in workers]
            if not (scene in self._compiled or is_first):
                continue
            if is_held(run.folder(self.folder)):
                if run.number not in self._held_by_others:
                    self._print(f"  {run.name} runs in another process: waiting for its end")
                self._held_by_others.add(run.number)
                continue
            waiting.remove(run)
            status = run_status(self.folder, run)
            if run.number in self._held_by_others and status.state in ("finished", "failed"):
                # who held it has ended it
                code = ExitCode.NORMAL if status.state == "finished" else ExitCode.SOLVER
                self._report(run, status, code)
                continue
            workers.append(self._start(run, status.state in ("stopped", "killed")))

    def _start(self, run: Run, continues: bool) -> Worker:
        folder = run.folder(self.folder)
        with reported(folder):
            folder.mkdir(parents=True, exist_ok=True)
            if not continues:
                clear(self.folder, run)
            record(self.folder, run, "running")
            with (folder / ERRORS).open("w", encoding="utf-8") as errors:
                own = start(self.deck, folder, run.overrides, continues, errors, self.jobs)
                return Worker(run, own)

    def _finish(self, worker: Worker) -> None:
        """Store the outcome of a run."""
        run, code = worker.run, worker.process.returncode
        folder = run.folder(self.folder)
        self._compiled.add(self.scene(run))
        if code == -signal.SIGTERM and worker.is_stopping:
            # asked before its first step
            code = int(ExitCode.STOPPED)
        state = STATES.get(code, "killed" if code < 0 else "failed")
        status = status_of(folder)
        stated = str(status.get("message", "")) if status.get("exit_code") == code else ""
        message = reason(code, stated, (folder / ERRORS).read_text("utf-8", "replace"))
        if state == "stopped" and not self.is_stopping:
            message = f"out of time: {message}"
        message = printable(message)
        record(self.folder, run, state, code, message)
        self._report(run, RunStatus(state, "" if state == "finished" else message), code)
        if state == "finished" and self.after_first is not None:
            self.after_first()
            self.after_first = None

    def _report(self, run: Run, status: RunStatus, code: int) -> None:
        self.states[run.number], self.codes[run.number] = status, code
        self._ended += 1
        why = f", exit code {code}: {status.message}" if status.message else ""
        self._print(f"  {run.name} {status.state}{why}")

    def _monitor(self, workers: Sequence[Worker], waiting: int) -> None:
        """Once a second: progress of all runs, and those that are out of time."""
        now = time.monotonic()
        is_terminal = sys.stdout.isatty()
        for worker in workers:
            status = status_of(worker.run.folder(self.folder)) if not worker.is_compiled else {}
            if status.get("pid") == worker.process.pid and (status.get("cycle") or 0) > 0:
                worker.is_compiled = True
                self._compiled.add(self.scene(worker.run))
            if (
                self.time_limit
                and now - worker.started > self.time_limit
                and not worker.is_stopping
            ):
                worker.is_stopping = True
                worker.process.terminate()
        if now - self._last_line < (1.0 if is_terminal else LINE_INTERVAL):
            return
        self._last_line = now
        for worker in workers:
            worker.progress = _time_fraction(status_of(worker.run.folder(self.folder)))
        line = self._progress(workers, waiting)
        if is_terminal:
            with suppress(OSError):
                sys.stdout.write(f"\r\x1b[K{line}")
                sys.stdout.flush()
        else:
            print_line(line)

    def _progress(self, workers: Sequence[Worker], waiting: int) -> str:
        """One line about all runs."""
        counts = Counter(status.state for status in self.states.values())
        ended = ", ".join(f"{n} {state}" for state, n in sorted(counts.items()))
        some = [f"{w.run.name} {100.0 * w.progress:.0f} %" for w in workers[:SHOWN]]
        running = ", ".join(some) + (", ..." if len(workers) > SHOWN else "")
        parts = [ended, f"running {running}" if some else "", f"{waiting} waiting"]
        done = self._ended + sum(worker.progress for worker in workers)
        if done > 0.0:
            left = (time.monotonic() - self._started) * (self._count - done) / done
            parts.append(f"{_duration(left)} left")
        return "; ".join(filter(None, parts))

    def _print(self, text: str) -> None:
        self._clear_line()
        print_line(printable(text))

    def _clear_line(self) -> None:
        try:
            if sys.stdout.isatty():
                sys.stdout.write("\r\x1b[K")
        except OSError:
            discard_output(sys.stdout)


# signals that are handled, and the signal that the runs get for each
_SIGNALS: dict[int, int] = {
    signal.SIGTERM: signal.SIGTERM,
    signal.SIGINT: signal.SIGTERM,
    signal.SIGUSR1: signal.SIGUSR1,
}


def _time_fraction(status: dict[str, object]) -> float:
    """Fraction of its time span that a run has completed."""
    now, end = status.get("time"), status.get("end_time")
    if not isinstance(now, int | float) or not isinstance(end, int | float) or end <= 0:
        return 0.0
    return min(max(now / end, 0.0), 1.0)


def _duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
