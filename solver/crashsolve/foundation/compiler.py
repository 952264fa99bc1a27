"""The process that compiles: `python -m crashsolve.foundation.compiler SOURCE PATH NAMES`.

The layout of the tables comes by standard input; the symbols' names and the object code go to PATH.
"""

import gc
import os
import pickle
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import module_from_spec, spec_from_file_location
from io import BytesIO
from pathlib import Path
from types import ModuleType
from typing import Any

from crashsolve.foundation.cache import CacheError, read_sealed, write_sealed
from crashsolve.foundation.errors import ExitCode

# what two threads share of a scene with elements, in the names that numba gives
APART = re.compile(r"\d(deform|open_points|close_points|press)B")


def import_file(source: Path) -> ModuleType:
    """Import a source file under its own stem."""
    name = source.stem
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, source)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    # before execution: numba finds the classes of a cached signature by this name
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def hand_on_bitcode() -> None:
    """Let numba hand on what it compiles as bitcode: nothing is called in this process.

    Machine code of every function for itself would take a seventh of the time; to optimise each
    before it becomes part of another, an eighth.
    """
    os.environ["NUMBA_OPT"] = "0"
    from numba.core import types
    from numba.core.codegen import AOTCodeLibrary, JITCPUCodegen
    from numba.core.cpu import CPUContext

    class Bitcode(AOTCodeLibrary):  # type: ignore[misc]
        serialize_using_object_code = AOTCodeLibrary.serialize_using_bitcode

    def no_address(context: Any, *_: Any, info: str) -> Any:
        # that of the Python object of a called kernel is unused, and would keep it out of the cache
        return context.get_constant_null(types.voidptr)

    def get_executable(_: Any, library: Any, *__: Any) -> Any:
        library._ensure_finalized()
        # numba tells functions apart by something that could be called
        return [].append

    JITCPUCodegen._library_class = Bitcode  # type: ignore[assignment]
    CPUContext.get_executable = get_executable  # type: ignore[method-assign]
    CPUContext.add_dynamic_addr = no_address  # type: ignore[assignment, method-assign]
    # nor has a kernel a Python environment, or a place in this process
    JITCPUCodegen.set_env = lambda *_: None  # type: ignore[method-assign]
    JITCPUCodegen._add_module = lambda *_: None  # type: ignore[method-assign]


def seal_kernels() -> None:
    """Let numba keep kernels with a checksum; a damaged one is compiled anew."""
    from numba.core import caching

    @contextmanager
    def open_for_write(_: Any, path: str) -> Iterator[BytesIO]:
        file = BytesIO()
        yield file
        # the checksum tells of one that a power cut has spoilt
        write_sealed(Path(path), file.getvalue(), sync=False)

    def open_sealed(path: str, *mode: Any) -> Any:
        if not path.endswith((".nbi", ".nbc")):
            return open(path, *mode)
        content = read_sealed(Path(path))
        if content is None:
            # what numba takes for a kernel that is not there yet
            raise FileNotFoundError(path)
        return BytesIO(content)

    setattr(caching.IndexDataCacheFile, "_open_for_write", open_for_write)  # noqa: B010
    setattr(caching, "open", open_sealed)  # noqa: B010


def keep_apart(module: Any) -> None:
    """Leave some functions as they are where they are called: the same bits in every scene."""
    for function in module.functions:
        if APART.search(function.name):
            function.add_function_attribute("noinline")


def optimise(module: Any, machine: Any, vectors: bool) -> None:
    """Optimise all functions of a module together."""
    import llvmlite.binding as llvm

    if vectors:
        # loops over lanes are not unrolled before they are vectorised, those over components are
        llvm.set_option("", "-unroll-full-max-count=8")
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    # scalar kernels have nothing to vectorise, and the search for it takes time
    options.loop_vectorization, options.slp_vectorization = vectors, False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)


def main(source: Path, path: Path, names: list[str]) -> None:
    """Compile functions of a file for given tables."""
    # the compiler's garbage goes with the process: a tenth of the time
    gc.disable()
    hand_on_bitcode()
    seal_kernels()
    import llvmlite.binding as llvm
    from numba.core import types

    from crashsolve.foundation.machine import host_machine
    from crashsolve.foundation.table_types import TablesKind

    layout, places = pickle.load(sys.stdin.buffer)
    if "lanes" in places:
        import crashsolve.foundation.lanes_types  # noqa: F401
    if "turns" in places:
        import crashsolve.foundation.atomic_types  # noqa: F401
    symbols, texts = [], []
    for name in names:
        function = getattr(import_file(source), name)
        function.compile((types.float64, types.boolean, TablesKind(layout, places)))
        signature = function.signatures[0]
        symbols.append(function.overloads[signature].fndesc.llvm_func_name)
        texts.append(function.inspect_llvm(signature))
    # elements in blocks are what loops over lanes are for
    vectors = "lanes" in places
    module, machine = llvm.parse_assembly(texts[0]), host_machine(vectors)
    for text in texts[1:]:
        module.link_in(llvm.parse_assembly(text))
    if vectors:
        keep_apart(module)
    optimise(module, machine, vectors)
    write_sealed(path, " ".join(symbols).encode() + b"\n" + machine.emit_object(module))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
    except (OSError, CacheError) as error:
        print(error, file=sys.stderr)
        sys.exit(ExitCode.OUTPUT)
