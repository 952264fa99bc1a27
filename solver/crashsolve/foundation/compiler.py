"""The process that compiles: `python -m crashsolve.foundation.compiler SOURCE NAME PATH`.

The layout of the tables comes by standard input; the symbol's name and the object code go to PATH.
"""

import gc
import os
import pickle
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


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


def main(source: Path, name: str, path: Path) -> None:
    """Compile one function of a file for given tables."""
    # the compiler's garbage goes with the process: a tenth of the time
    gc.disable()
    import llvmlite.binding as llvm
    from numba.core import types

    from crashsolve.foundation.machine import host_machine
    from crashsolve.foundation.table_types import TablesKind

    kind = TablesKind(*pickle.load(sys.stdin.buffer))
    function = getattr(import_file(source), name)
    function.compile((types.float64, types.boolean, kind))
    signature = function.signatures[0]
    symbol = function.overloads[signature].fndesc.llvm_func_name
    module = llvm.parse_assembly(function.inspect_llvm(signature))
    code = host_machine().emit_object(module)
    temporary = path.with_suffix(f".{os.getpid()}")
    temporary.write_bytes(symbol.encode() + b"\n" + code)
    os.replace(temporary, path)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
