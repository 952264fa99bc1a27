"""A run in a copy of the process of its sweep, which has imported all that runs need.

The copy has none of the files and locks of its sweep: it is an ordinary process, which lives on
where the sweep is killed, and has a memory of its own.
"""

from __future__ import annotations

import atexit
import os
import runpy
import signal
import sys
import traceback
from collections.abc import Collection, Iterable, Sequence
from importlib import import_module
from typing import IO

from crashsolve.deck.run_cards.control import CORES_GIVEN
from crashsolve.foundation.errors import ExitCode

# what runs import only when they need it
LATE = ("h5py", "crashsolve.simulation.solve", "crashsolve.statics.start")


def import_all() -> None:
    """Import what most runs need, once for all of them."""
    from crashsolve.compiler.machine import load_linker

    load_linker()
    for name in LATE:
        import_module(name)


class ForkedRun:
    """A command of crashsolve in a process of its own; its standard error goes to `errors`.

    `signals` are those for which this process has handlers: the copy has none. `is_one_of_several`:
    runs side by side share the cores that a job was given. `returncode` is None until it has ended;
    below 0 where a signal ended it.
    """

    def __init__(
        self,
        words: Sequence[str],
        errors: IO[str],
        signals: Collection[int],
        is_one_of_several: bool = False,
    ) -> None:
        self.returncode: int | None = None
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        # none may reach the copy while it has the handlers of this process
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
        self.pid = os.fork()
        if self.pid == 0:
            if is_one_of_several:
                os.environ[CORES_GIVEN] = "1"
            _run(words, errors, signals, blocked)
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal, if it still runs."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        """Ask it to stop."""
        self.send_signal(signal.SIGTERM)


def _run(
    words: Sequence[str], errors: IO[str], signals: Collection[int], blocked: Iterable[int]
) -> None:
    """The command, in the copy; ends this process."""
    code = int(ExitCode.INTERNAL)
    # what the sweep does at its end is not for the run to do, but what it registers itself is
    atexit._clear()
    try:
        for number in signals:
            is_interrupt = number == signal.SIGINT
            handler = signal.default_int_handler if is_interrupt else signal.SIG_DFL
            signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        null = os.open(os.devnull, os.O_RDWR)
        for number, stream in enumerate((null, null, errors.fileno())):
            os.dup2(stream, number)
        # the files of the sweep, above all its locks; not closed, or an object that closes its file
        # when it is forgotten would close a file of the run
        for number in map(int, os.listdir("/proc/self/fd")):
            if number > 2:
                os.dup2(null, number)
        # those of the sweep may be anywhere
        sys.stdout, sys.stderr = (open(n, "w", encoding="utf-8") for n in (1, 2))  # noqa: SIM115
        sys.argv = ["crashsolve", *words]
        runpy.run_module("crashsolve", run_name="__main__")
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else code
    except BaseException:
        traceback.print_exc()
    finally:
        atexit._run_exitfuncs()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(code)
