"""Commands in processes that begin with the solver imported: imports cost more than a small run.

A server that has imported the solver, and run nothing, forks itself for every command, and for the
compiler of a command or of a test. The child has the environment, folder and streams that a process
of its own would have. What a run imports, how it answers to signals, and runs that compile at once
are tested with real starts (`start` of command.py).
"""

import atexit
import io
import multiprocessing
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from crashsolve import cli
from crashsolve.compiler import machine, process
from crashsolve.compiler.cache import read_sealed

PACKAGE = Path(cli.__file__).parent
# packages of other commands than run, check and explain: they import more
APART = ("__main__", "examples", "study", "sweep")
# what is read when a run asks for it; whatever else changes in the environment needs a real start
READ_LATE = {"CRASHSOLVE_CACHE", "CRASHSOLVE_PLAIN", "PYTEST_CURRENT_TEST"}

# source, path, names and slots of tables of what is to be compiled
Request = tuple[Path, Path, list[str], dict[str, object]]
# what runs have in place of this, here
_apart = machine._compile_apart


@cache
def _server() -> tuple[Any, dict[str, str]]:
    """What starts processes from the server, and the environment that the server has."""
    server = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(["h5py", *_modules()])
    return server, dict(os.environ)


def _modules() -> list[str]:
    """All modules of the solver but those of other commands."""
    names = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts[0] not in APART:
            words = parts[:-1] if parts[-1] == "__init__" else parts
            names.append(".".join((PACKAGE.name, *words)))
    return names


def can_fork(environment: dict[str, str]) -> bool:
    """Whether a process of the server would see this environment as one of its own does."""
    _, has = _server()
    different = {name for name, _ in environment.items() ^ has.items()}
    return different <= READ_LATE


def completed(
    words: list[str], environment: dict[str, str], timeout: float
) -> subprocess.CompletedProcess[str]:
    """`crashsolve WORDS` at its end. Raises subprocess.TimeoutExpired after `timeout` [s]."""
    server, _ = _server()
    with tempfile.TemporaryDirectory() as folder:
        streams = [str(Path(folder) / name) for name in ("out", "err")]
        process = server.Process(target=_run, args=(words, environment, os.getcwd(), streams))
        process.start()
        process.join(timeout)
        if process.exitcode is None:
            process.kill()
            raise subprocess.TimeoutExpired(words, timeout)
        out, err = (Path(name).read_text("utf-8") for name in streams)
    return subprocess.CompletedProcess(words, process.exitcode, out, err)


def compiled(
    source: Path, names: tuple[str, ...], tables: Any, path: Path, lock: int | None = None
) -> bytes:
    """Machine code at `path`, for a scene that a test builds in its own process.

    What goes wrong is reported by machine._compile_apart, anew.
    """
    environment = dict(os.environ)
    code = None
    if can_fork(environment):
        server, _ = _server()
        request = source, path, list(names), tables.slots
        child = server.Process(target=_compile_for, args=(environment, request))
        child.start()
        child.join()
        code = read_sealed(path) if child.exitcode == 0 else None
    return _apart(source, names, tables, path, lock) if code is None else code


def _compile_for(environment: dict[str, str], request: Request) -> None:
    """Compile in this process, which is for it alone."""
    os.environ.clear()
    os.environ.update(environment)
    _compile_here(*request)


def _run(words: list[str], environment: dict[str, str], folder: str, streams: list[str]) -> None:
    """The command, in the process that is for it."""
    for number, name in enumerate(streams, 1):
        descriptor = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["crashsolve", *words]
    compiler = Compiler()
    machine._compile_apart = compiler.code
    try:
        sys.exit(cli.main())
    finally:
        compiler.end()
        # multiprocessing leaves them out
        atexit._run_exitfuncs()


class Compiler:
    """A process that forks itself whenever its run compiles.

    It is there before the run, which has a thread by then and must not be forked any more.
    """

    def __init__(self) -> None:
        self._requested, there = multiprocessing.Pipe()
        self._process = os.fork()
        if self._process == 0:
            self._requested.close()
            # until the run has closed its end, or died
            with suppress(EOFError):
                while True:
                    there.send(_compile(*there.recv()))
            os._exit(0)
        there.close()

    def code(
        self,
        source: Path,
        names: tuple[str, ...],
        tables: Any,
        path: Path,
        lock: int | None = None,
    ) -> bytes:
        """Machine code at `path`; what goes wrong is reported by machine._compile_apart, anew."""
        self._requested.send((source, path, list(names), tables.slots))
        code = read_sealed(path) if self._requested.recv() == 0 else None
        return _apart(source, names, tables, path, lock) if code is None else code

    def end(self) -> None:
        self._requested.close()
        os.waitpid(self._process, 0)


def _compile(*request: Any) -> int:
    """Compile in a process of its own; its exit code."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            _compile_here(*request)
            code = 0
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _compile_here(source: Path, path: Path, names: list[str], slots: Mapping[str, object]) -> None:
    sys.stdin = io.TextIOWrapper(io.BytesIO(pickle.dumps(slots)))
    process.main(source, path, names)
