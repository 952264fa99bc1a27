"""The process that compiles: `python -m crashsolve.compiler.process SOURCE PATH NAMES`.

The tables come by standard input, the object code goes to PATH. It is kept by its text in LLVM's
language too: after a change of sources that leaves a scene's kernels as they are, the code that
was made before serves again.
"""

import gc
import hashlib
import pickle
import sys
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


def optimise(module: llvm.ModuleRef, target: llvm.TargetMachine, vectors: bool) -> None:
    """Optimise all functions of a module together."""
    if vectors:
        # loops over lanes are not unrolled before they are vectorised, those over components are
        llvm.set_option("", "-unroll-full-max-count=8")
    else:
        # loops over rows and bodies are short: a copy for many turns costs a quarter of the time
        # of compiling, and saves none
        llvm.set_option("", "-unroll-runtime=false")
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    # scalar kernels have nothing to vectorise, and the search for it takes time
    options.loop_vectorization, options.slp_vectorization = vectors, False
    builder = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)


def main(source: Path, path: Path, names: list[str]) -> None:
    """Compile functions of a file for given tables."""
    # memory of the compiler is freed with the process, which saves a tenth of the time
    gc.disable()
    slots = pickle.load(sys.stdin.buffer)
    functions, kernels = machine.import_file(source), Module(slots, machine.runs_checked())
    for name in names:
        kernels.entry(getattr(functions, name), name)
    text = kernels.text()
    cached = path.parent.with_name("code") / f"{_fingerprint(text, kernels.has_lanes)}.o"
    code = read_sealed(cached)
    if code is None:
        code = object_code(text, kernels.has_lanes)
        make_private(cached.parent)
        refuse_foreign(cached.parent)
        write_sealed(cached, code)
    write_sealed(path, code)


def _fingerprint(text: str, has_lanes: bool) -> str:
    """A name for the code of a text: of all that it depends on."""
    digest = hashlib.sha256(f"{machine.processor()} {llvmlite.__version__} {has_lanes}".encode())
    for source in (Path(__file__), Path(machine.__file__)):
        digest.update(source.read_bytes())
    digest.update(text.encode())
    return digest.hexdigest()[:32]


def object_code(text: str, vectors: bool) -> bytes:
    """Machine code of a text; loops over lanes serve elements in blocks."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module, target = llvm.parse_assembly(text), machine.host_machine(vectors)
    optimise(module, target, vectors)
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
