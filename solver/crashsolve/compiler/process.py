"""The process that compiles: `python -m crashsolve.compiler.process SOURCE PATH NAMES`.

The tables come by standard input, the object code goes to PATH. The code of every unit of the
module is kept by its text in LLVM's language too: of a scene only those units are compiled that no
other scene, and no version of the sources, has had. Two processes share the work where it is long
(work.py).
"""

import gc
import hashlib
import os
import pickle
import sys
from functools import partial
from pathlib import Path

import llvmlite

from crashsolve.compiler import machine, optimisation
from crashsolve.compiler.cache import (
    CacheError,
    make_private,
    read_sealed,
    refuse_foreign,
    write_sealed,
)
from crashsolve.compiler.translation.module import Module, TranslationError
from crashsolve.compiler.work import Unit, Work
from crashsolve.foundation.errors import ExitCode


def main(source: Path, path: Path, names: list[str]) -> None:
    """Compile functions of a file for given tables."""
    # memory of the compiler is freed with the process, which saves a tenth of the time
    gc.disable()
    slots = pickle.load(sys.stdin.buffer)
    folder = path.parent.with_name("code")
    make_private(folder)
    refuse_foreign(folder)
    has_lanes = "lanes" in slots
    context, work = _context(has_lanes), Work(partial(optimisation.object_code, vectors=has_lanes))
    units: dict[Path, bytes | None] = {}

    def look_up(name: str, text: str) -> None:
        kept = folder / f"{name}.{context}.o"
        if kept not in units:
            units[kept] = read_sealed(kept)
            if units[kept] is None:
                work.add(Unit(kept, text))

    functions, kernels = machine.import_file(source), Module(slots, machine.runs_checked(), look_up)
    for name in names:
        kernels.entry(getattr(functions, name), name)
    kernels.finish()
    work.finish()
    codes = [work.codes.get(kept, code) for kept, code in units.items()]
    write_sealed(path, pickle.dumps(codes))


def _context(has_lanes: bool) -> str:
    """A name for all that code depends on beside its text."""
    digest = hashlib.sha256(f"{machine.processor()} {llvmlite.__version__} {has_lanes}".encode())
    for module in (optimisation, machine):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()[:16]


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
    except (OSError, CacheError) as error:
        print(error, file=sys.stderr)
        sys.exit(ExitCode.OUTPUT)
    except TranslationError as error:
        sys.exit(str(error))
    # all files are whole, and the end of Python would tidy up a tenth of a second long
    os._exit(ExitCode.NORMAL)
