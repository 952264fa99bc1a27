"""Machine code: made by another process, kept in the cache folder, loaded into this one.

A run imports no compiler: it costs memory and time, and in the process that compiles, a call may
reach another version of a kernel than later, with other round-off. So every run of a scene, the
first included, executes the same file. Of several runs that begin together one has it compiled,
the others wait.

The process that compiles is `python -m crashsolve.compiler.process`.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import pickle
import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryFile
from types import ModuleType
from typing import TYPE_CHECKING, Protocol

from crashsolve.compiler.cache import (
    CacheError,
    cache_folder,
    free_lock,
    locked,
    read_sealed,
)
from crashsolve.compiler.pages import release_pages
from crashsolve.compiler.table import Slot, Tables, layout_of
from crashsolve.foundation.errors import CrashsolveError, ExitCode

if TYPE_CHECKING:
    import subprocess

    import llvmlite.binding as llvm


class BoundsError(CrashsolveError):
    """A kernel has left the bounds of a table, a column, a tuple or an integer."""


class CompileError(CrashsolveError):
    """A kernel is none that can be translated: a law's, or one of the solver."""


Function = Callable[[float, bool, Tables], None]


class Engine(Protocol):
    """Owner of loaded code."""

    def get_function_address(self, name: str) -> int:
        """Where a function begins."""


class Failure(ctypes.Structure):
    """Failure of a check of bounds: location, index, and its limit."""

    _fields_ = (
        ("site", ctypes.c_char_p),
        ("number", ctypes.c_int64),
        ("limit", ctypes.c_int64),
    )


# functions by the file they are kept in
_linked: dict[Path, tuple[Function, ...]] = {}
# processes that compile for this one, by the file they make
_ahead: dict[Path, subprocess.Popen[bytes]] = {}
# function(number, flag, tables)
SIGNATURE = ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.c_bool, ctypes.c_void_p)


def machine_code(source: Path, name: str, tables: Tables) -> Function:
    """The function `name` of a source file, compiled for tables of this layout.

    Raises: CompileError with the compiler's message when it cannot be compiled, CacheError where
    compiled code cannot be kept.
    """
    if runs_plain():
        return plain(source, name)
    return machine_codes(source, (name,), tables)[0]


def machine_codes(source: Path, names: tuple[str, ...], tables: Tables) -> tuple[Function, ...]:
    """Several functions of a file, compiled together: functions that they share are compiled once.

    Raises: CompileError with the compiler's message when they cannot be compiled, CacheError where
    compiled code cannot be kept.
    """
    path = _object_file(source, names, tables.slots)
    # once: the broad phase asks again at every renewal
    if path not in _linked:
        if path in _ahead:
            # what went wrong there shows where it is compiled again
            _ahead.pop(path).wait()
            content = _compile_once(source, names, tables, path)
        else:
            content = read_sealed(path) or _compile_once(source, names, tables, path)
        _linked[path] = _link(names, content)
    return _linked[path]


def compile_ahead(source: Path, names: tuple[str, ...], slots: dict[str, Slot]) -> None:
    """Have functions compiled for tables that will be made, while this process goes on.

    Nothing is begun where another process does so. Raises: CacheError.
    """
    if runs_plain() or (path := _object_file(source, names, slots)).exists():
        return
    lock = free_lock(path)
    if lock is not None:
        import subprocess

        with TemporaryFile() as given:
            given.write(pickle.dumps(slots))
            given.seek(0)
            _ahead[path] = subprocess.Popen(
                _command(source, names, path),
                stdin=given,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
                pass_fds=(lock,),
            )
        # that process holds it
        os.close(lock)


def _object_file(source: Path, names: tuple[str, ...], slots: dict[str, Slot]) -> Path:
    """Where the code of some functions is kept. Raises CacheError."""
    kind = f"{layout_of(slots)}.{processor()}{'.checked' * runs_checked()}"
    return cache_folder() / f"{source.stem}.{'.'.join(names)}.{kind}.o"


def _command(source: Path, names: tuple[str, ...], path: Path) -> list[str]:
    """The command that compiles functions of a file."""
    words = [sys.executable, "-m", "crashsolve.compiler.process", source, path, *names]
    return [str(word) for word in words]


@cache
def processor() -> str:
    """Name of this processor, and a hash of its features: one name may stand for several
    processors.
    """
    name, features = _host()
    return f"{name}-{hashlib.sha256(features.encode()).hexdigest()[:8]}"


@cache
def _host() -> tuple[str, str]:
    """Name and features of this processor, as LLVM has them."""
    import llvmlite.binding as llvm

    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def runs_plain() -> bool:
    """Whether nothing is to be compiled."""
    return os.environ.get("CRASHSOLVE_PLAIN", "0") not in ("", "0")


def runs_checked() -> bool:
    """Whether compiled code checks the bounds of every access."""
    return os.environ.get("CRASHSOLVE_CHECKED", "0") not in ("", "0")


def plain(source: Path, name: str) -> Function:
    """A function of composed source as plain Python, for debugging and coverage."""
    function: Function = getattr(import_file(source), name)
    return function


def import_file(source: Path) -> ModuleType:
    """Import a source file under its own stem."""
    name = source.stem
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, source)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def _compile_once(source: Path, names: tuple[str, ...], tables: Tables, path: Path) -> bytes:
    """Machine code at `path`, made here or by another run that was first.

    Raises: CompileError with the compiler's message, CacheError when the code cannot be kept.
    """
    with locked(path) as lock:
        return read_sealed(path) or _compile_apart(source, names, tables, path, lock)


def _compile_apart(
    source: Path, names: tuple[str, ...], tables: Tables, path: Path, lock: int | None = None
) -> bytes:
    """Machine code, written to `path` by a process of its own, which no signal to this one reaches.

    That process holds the lock too: should this one die, others still wait for its file.
    Raises: CompileError with the compiler's message, CacheError when the code cannot be kept.
    """
    # with compiled code in the cache there is none
    import subprocess

    done = subprocess.run(
        _command(source, names, path),
        input=pickle.dumps(tables.slots),
        stderr=subprocess.PIPE,
        start_new_session=True,
        pass_fds=() if lock is None else (lock,),
    )
    message = done.stderr.decode(errors="replace")[-4000:]
    if done.returncode == ExitCode.OUTPUT:
        raise CacheError(message.strip())
    if done.returncode < 0:
        raise CacheError(f"the compiler was killed by signal {-done.returncode}: out of memory?")
    if done.returncode:
        raise CompileError(f"cannot compile {source}: {message.strip()}")
    code = read_sealed(path)
    if code is None:
        raise CacheError(f"the compiled code {path} cannot be read back; check the disk")
    return code


def _link(names: tuple[str, ...], code: bytes) -> tuple[Function, ...]:
    """Functions of some object files, linked into this process."""
    # commands that only read a deck do not load it
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    unused = llvm.parse_assembly("")
    engine = llvm.create_mcjit_compiler(unused, host_machine())
    # compiling even an empty module takes longer than all else here
    engine.remove_module(unused)
    for unit in pickle.loads(code):
        engine.add_object_file(llvm.ObjectFileRef.from_data(unit))
    engine.finalize_object()
    forget_linker()
    return tuple(_function(engine, name) for name in names)


def load_linker() -> None:
    """Load LLVM while the process is small: 40 MB for a moment, which would add to the peak of a
    process that holds a model.
    """
    if not runs_plain():
        import_module("llvmlite.binding")
        forget_linker()


def forget_linker() -> None:
    """Release the memory of LLVM: its start alone takes 35 MB, and loading a step needs 6 of
    them.
    """
    release_pages("libllvmlite")


def _function(engine: Engine, name: str) -> Function:
    """A compiled function, as Python calls it."""
    address = engine.get_function_address(name)
    call = SIGNATURE(address)

    def function(number: float, flag: bool, tables: Tables) -> None:
        call(number, flag, tables.pointer)

    # the code lives as long as its engine
    function.keep = engine  # type: ignore[attr-defined]
    function.address = address  # type: ignore[attr-defined]
    return _checked(function, engine) if runs_checked() else function


def _checked(function: Function, engine: Engine) -> Function:
    """A compiled function that raises BoundsError after the first access out of bounds."""
    address = ctypes.CFUNCTYPE(ctypes.c_void_p)(engine.get_function_address("first_failure"))()
    failure = Failure.from_address(address)

    def checked(number: float, flag: bool, tables: Tables) -> None:
        function(number, flag, tables)
        if failure.site:
            location = failure.site.decode(errors="replace")
            failure.site = None
            message = f"{location}: {failure.number} is out of bounds, the limit is {failure.limit}"
            raise BoundsError(message)

    return checked


def host_machine(vectors: bool = False) -> llvm.TargetMachine:
    """The compiler's target: this processor, code to be loaded into a process."""
    import llvmlite.binding as llvm

    target = llvm.Target.from_default_triple()
    cpu, features = _host()
    if vectors and "+avx512f" in features:
        # a tenth of the time of shells
        features += ",-prefer-256-bit"
    return target.create_target_machine(
        cpu=cpu, features=features, opt=3, reloc="static", codemodel="jitdefault", jit=True
    )
