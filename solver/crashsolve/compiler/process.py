"""The process that compiles: `python -m crashsolve.compiler.process SOURCE PATH NAMES`.

The tables come by standard input, the object code goes to PATH. The code of every unit of the
module is kept by its text in LLVM's language too: of a scene only those units are compiled that no
other scene, and no version of the sources, has had. Two processes share the work where it is long.
"""

import gc
import hashlib
import os
import pickle
import sys
from functools import cache
from pathlib import Path

import llvmlite
import llvmlite.binding as llvm

from crashsolve.compiler import machine
from crashsolve.compiler.cache import (
    CacheError,
    make_private,
    read_sealed,
    refuse_foreign,
    write_sealed,
)
from crashsolve.compiler.translation.module import Module, TranslationError
from crashsolve.foundation.errors import ExitCode

# characters of text in which a process of its own is worth its start, some tenths of a second
LONG = 400_000


def main(source: Path, path: Path, names: list[str]) -> None:
    """Compile functions of a file for given tables."""
    # memory of the compiler is freed with the process, which saves a tenth of the time
    gc.disable()
    slots = pickle.load(sys.stdin.buffer)
    functions, kernels = machine.import_file(source), Module(slots, machine.runs_checked())
    for name in names:
        kernels.entry(getattr(functions, name), name)
    folder = path.parent.with_name("code")
    make_private(folder)
    refuse_foreign(folder)
    context = _context(kernels.has_lanes)
    units = {folder / f"{name}.{context}.o": text for name, text in kernels.units().items()}
    codes = {kept: read_sealed(kept) for kept in units}
    missing = {kept: units[kept] for kept, code in codes.items() if code is None}
    codes |= compiled(missing, kernels.has_lanes)
    write_sealed(path, pickle.dumps(list(codes.values())))


def _context(has_lanes: bool) -> str:
    """A name for all that code depends on beside its text."""
    digest = hashlib.sha256(f"{machine.processor()} {llvmlite.__version__} {has_lanes}".encode())
    for source in (Path(__file__), Path(machine.__file__)):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def compiled(units: dict[Path, str], vectors: bool) -> dict[Path, bytes]:
    """Machine code of texts, kept in files."""
    shares = _shares({path: len(text) for path, text in units.items()})
    child = os.fork() if len(shares) > 1 else None
    if child == 0:
        try:
            _compile(shares[1], units, vectors)
        finally:
            os._exit(0)
    compiled_units = _compile(shares[0], units, vectors)
    if child is not None:
        os.waitpid(child, 0)
        codes = {path: read_sealed(path) for path in shares[1]}
        compiled_units |= {path: code for path, code in codes.items() if code is not None}
    # what the other process has not made shows its error here
    return compiled_units | _compile(
        [path for path in units if path not in compiled_units], units, vectors
    )


def _shares(lengths: dict[Path, int]) -> list[list[Path]]:
    """The work of one process, or of two."""
    longest = sorted(lengths, key=lambda path: -lengths[path])
    if sum(lengths.values()) < LONG or len(os.sched_getaffinity(0)) < 2:
        return [longest]
    shares, sums = ([], []), [0, 0]
    for path in longest:
        k = int(sums[1] < sums[0])
        shares[k].append(path)
        sums[k] += lengths[path]
    return list(shares)


def _compile(paths: list[Path], units: dict[Path, str], vectors: bool) -> dict[Path, bytes]:
    codes = {path: object_code(units[path], vectors) for path in paths}
    for path, code in codes.items():
        # a damaged file is made anew: there is no need to wait for the disk
        write_sealed(path, code, sync=False)
    return codes


@cache
def _target(vectors: bool) -> llvm.TargetMachine:
    """This processor, and LLVM's options for it, which are set once."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    if vectors:
        # loops over lanes are not unrolled before they are vectorised, those over components are
        llvm.set_option("", "-unroll-full-max-count=8")
    else:
        # loops over rows and bodies are short: a copy for many turns costs a quarter of the time
        # of compiling, and saves none
        llvm.set_option("", "-unroll-runtime=false")
    return machine.host_machine(vectors)


def object_code(text: str, vectors: bool) -> bytes:
    """Machine code of a text; loops over lanes serve elements in blocks."""
    target = _target(vectors)
    module = llvm.parse_assembly(text)
    # the higher levels take as long as all else; by them large scalar scenes are no faster,
    # those of a few bodies by 2 to 3 %
    options = llvm.create_pipeline_tuning_options(speed_level=3 if vectors else 1)
    # scalar kernels have nothing to vectorise, and the search for it takes time
    options.loop_vectorization, options.slp_vectorization = vectors, False
    builder = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)
    code: bytes = target.emit_object(module)
    return code


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
    except (OSError, CacheError) as error:
        print(error, file=sys.stderr)
        sys.exit(ExitCode.OUTPUT)
    except TranslationError as error:
        sys.exit(str(error))
