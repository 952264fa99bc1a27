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
from crashsolve.foundation.streams import give_up, printable, say
from crashsolve.output.files import reported
from crashsolve.output.lock import is_held
from crashsolve.study.child_runs import reason, start, status_of
from crashsolve.sweep.folder import ERRORS, Look, Run, clear, look, note

# [s] between two looks, and between two lines where standard output is no terminal
LOOK, LINE = 0.05, 60.0
SHOWN = 4
STATES = {int(ExitCode.NORMAL): "finished", int(ExitCode.STOPPED): "stopped"}
Scene = Callable[[Run], tuple[str, ...]]


@dataclass
class Worker:
    """A run and its process; `is_stopping` once it has been asked to stop."""

    run: Run
    process: subprocess.Popen[str]
    begun: float = field(default_factory=time.monotonic)
    is_warm: bool = False
    is_stopping: bool = False
    share: float = 0.0


@dataclass
class March:
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
    states: dict[int, Look] = field(default_factory=dict)
    codes: dict[int, int] = field(default_factory=dict)
    requests: list[int] = field(default_factory=list)
    is_stopping: bool = False

    def go(self, runs: Sequence[Run]) -> None:
        """Run all; afterwards `states` and `codes` have the outcome of each. Raises OutputError."""
        waiting, workers = list(runs), list[Worker]()
        self._warm: set[tuple[str, ...]] = set()
        self._held: set[int] = set()
        self._count, self._begun = len(waiting), time.monotonic()
        self._shown, self._ended = self._begun, 0
        before = {n: signal.signal(n, self._keep) for n in _SIGNALS}
        try:
            while waiting or workers:
                self._obey(workers)
                if self.is_stopping:
                    waiting.clear()
                self._fill(waiting, workers)
                for worker in [w for w in workers if w.process.poll() is not None]:
                    workers.remove(worker)
                    self._end(worker)
                self._look_at(workers, len(waiting))
                time.sleep(LOOK)
        finally:
            for worker in workers:
                worker.process.terminate()
            for number, handler in before.items():
                signal.signal(number, handler)
            self._clear_line()

    def _keep(self, number: int, _: object) -> None:
        self.requests.append(number)

    def _obey(self, workers: Sequence[Worker]) -> None:
        """Hand signals on to all runs."""
        while self.requests:
            number = self.requests.pop(0)
            for worker in workers:
                worker.process.send_signal(_SIGNALS[number])
            if number != signal.SIGUSR1:
                if not self.is_stopping:
                    self._say(f"stopping {len(workers)} runs, each with a dump")
                self.is_stopping = True
                for worker in workers:
                    worker.is_stopping = True

    def _fill(self, waiting: list[Run], workers: list[Worker]) -> None:
        """Start what may start now; a run that another process still holds waits for it."""
        for run in list(waiting):
            if len(workers) >= self.jobs:
                return
            scene = self.scene(run)
            is_first = scene not in [self.scene(w.run) for w in workers]
            if not (scene in self._warm or is_first):
                continue
            if is_held(run.folder(self.folder)):
                if run.number not in self._held:
                    self._say(f"  {run.name} runs in another process: waiting for its end")
                self._held.add(run.number)
                continue
            waiting.remove(run)
            found = look(self.folder, run)
            if run.number in self._held and found.state in ("finished", "failed"):
                # who held it has ended it
                code = ExitCode.NORMAL if found.state == "finished" else ExitCode.SOLVER
                self._report(run, found, code)
                continue
            workers.append(self._start(run, found.state in ("stopped", "killed")))

    def _start(self, run: Run, goes_on: bool) -> Worker:
        folder = run.folder(self.folder)
        with reported(folder):
            folder.mkdir(parents=True, exist_ok=True)
            if not goes_on:
                clear(self.folder, run)
            note(self.folder, run, "running")
            with (folder / ERRORS).open("w", encoding="utf-8") as errors:
                own = start(self.deck, folder, run.overrides, goes_on, errors, self.jobs)
                return Worker(run, own)

    def _end(self, worker: Worker) -> None:
        """Keep what became of a run."""
        run, code = worker.run, worker.process.returncode
        folder = run.folder(self.folder)
        self._warm.add(self.scene(run))
        if code == -signal.SIGTERM and worker.is_stopping:
            # asked before its first step
            code = int(ExitCode.STOPPED)
        state = STATES.get(code, "killed" if code < 0 else "failed")
        status = status_of(folder)
        reported = str(status.get("message", "")) if status.get("exit_code") == code else ""
        message = reason(code, reported, (folder / ERRORS).read_text("utf-8", "replace"))
        if state == "stopped" and not self.is_stopping:
            message = f"out of time: {message}"
        message = printable(message)
        note(self.folder, run, state, code, message)
        self._report(run, Look(state, "" if state == "finished" else message), code)
        if state == "finished" and self.after_first is not None:
            self.after_first()
            self.after_first = None

    def _report(self, run: Run, found: Look, code: int) -> None:
        self.states[run.number], self.codes[run.number] = found, code
        self._ended += 1
        why = f", exit code {code}: {found.message}" if found.message else ""
        self._say(f"  {run.name} {found.state}{why}")

    def _look_at(self, workers: Sequence[Worker], waiting: int) -> None:
        """Once a second: progress of all runs, and those that are out of time."""
        now = time.monotonic()
        is_terminal = sys.stdout.isatty()
        for worker in workers:
            status = status_of(worker.run.folder(self.folder)) if not worker.is_warm else {}
            if status.get("pid") == worker.process.pid and (status.get("cycle") or 0) > 0:
                worker.is_warm = True
                self._warm.add(self.scene(worker.run))
            if self.time_limit and now - worker.begun > self.time_limit and not worker.is_stopping:
                worker.is_stopping = True
                worker.process.terminate()
        if now - self._shown < (1.0 if is_terminal else LINE):
            return
        self._shown = now
        for worker in workers:
            worker.share = _share(status_of(worker.run.folder(self.folder)))
        line = self._progress(workers, waiting)
        if is_terminal:
            with suppress(OSError):
                sys.stdout.write(f"\r\x1b[K{line}")
                sys.stdout.flush()
        else:
            say(line)

    def _progress(self, workers: Sequence[Worker], waiting: int) -> str:
        """One line about all runs."""
        counts = Counter(found.state for found in self.states.values())
        ended = ", ".join(f"{n} {state}" for state, n in sorted(counts.items()))
        some = [f"{w.run.name} {100.0 * w.share:.0f} %" for w in workers[:SHOWN]]
        running = ", ".join(some) + (", ..." if len(workers) > SHOWN else "")
        parts = [ended, f"running {running}" if some else "", f"{waiting} waiting"]
        done = self._ended + sum(worker.share for worker in workers)
        if done > 0.0:
            left = (time.monotonic() - self._begun) * (self._count - done) / done
            parts.append(f"{_duration(left)} left")
        return "; ".join(filter(None, parts))

    def _say(self, text: str) -> None:
        self._clear_line()
        say(printable(text))

    def _clear_line(self) -> None:
        try:
            if sys.stdout.isatty():
                sys.stdout.write("\r\x1b[K")
        except OSError:
            give_up(sys.stdout)


# what is kept of signals, and what the runs get for each
_SIGNALS: dict[int, int] = {
    signal.SIGTERM: signal.SIGTERM,
    signal.SIGINT: signal.SIGTERM,
    signal.SIGUSR1: signal.SIGUSR1,
}


def _share(status: dict[str, object]) -> float:
    """How much of its time span a run has behind it."""
    now, end = status.get("time"), status.get("end_time")
    if not isinstance(now, int | float) or not isinstance(end, int | float) or end <= 0:
        return 0.0
    return min(max(now / end, 0.0), 1.0)


def _duration(seconds: float) -> str:
    """A time as people say it."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
