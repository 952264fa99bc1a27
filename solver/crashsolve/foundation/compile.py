"""The one way to compile a function, and the folder where compiled code is kept.

Numba trusts a cached caller even after a callee in another file has changed. The cache folder is
therefore named after a hash of every source file of the package, and set before numba loads.
"""

import hashlib
import os
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from crashsolve.foundation.cache import find_folder

F = TypeVar("F", bound=Callable[..., Any])

PACKAGE = Path(__file__).resolve().parent.parent
COMPILING = os.environ.get("CRASHSOLVE_COMPILING") == "1"
CALLABLE = os.environ.get("CRASHSOLVE_CALL_KERNELS") == "1"
# contraction and reassociation only: NaN and infinity must keep their meaning for the guards
FLOAT_FLAGS = {"contract", "nsz", "arcp", "reassoc"}
# without what Python would call a function by
UNWRAPPED = {"no_cpython_wrapper": not CALLABLE, "no_cfunc_wrapper": True}


@cache
def cache_folder() -> Path:
    """Folder for composed steps and compiled code of exactly these sources. Raises CacheError."""
    digest = hashlib.sha256(b"callable" if CALLABLE else b"")
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return find_folder(digest.hexdigest()[:16])


def kernel(function: F) -> F:
    """Compile `function` for other compiled functions; plain Python where nothing is compiled.

    Without the wrapper that Python would call it by, it compiles in two thirds of the time. Tests
    that call compiled kernels from Python set CRASHSOLVE_CALL_KERNELS=1.
    """
    return _compile(function, cache=True, **UNWRAPPED)


def blockwise(function: F) -> F:
    """A kernel with loops over the lanes of a block, no two of whose tables and columns overlap.

    So nothing it writes is anything else that it reads, and the loops need no test for it.
    """
    return _compile(function, cache=True, noalias=True, **UNWRAPPED)


def inlined(function: F) -> F:
    """A kernel that becomes part of its caller, so that literal sizes unroll its loops."""
    return _compile(function, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def stage(function: F) -> F:
    """A stage of the step that has one caller: its text is taken into it before compilation."""
    return _compile(function, inline="always")


def entry(function: F) -> F:
    """Compile a function of a number, a flag and tables, that machine.py hands to Python."""
    return _compile(function, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def set_up_numba() -> None:
    """What numba must know before it is imported."""
    # never that of a process which started this one, for other sources perhaps
    os.environ["NUMBA_CACHE_DIR"] = str(cache_folder())
    # scalar kernels have nothing to vectorise, and the search for it costs a fifth of compilation
    os.environ.setdefault("NUMBA_LOOP_VECTORIZE", "0")
    os.environ.setdefault("NUMBA_SLP_VECTORIZE", "0")


def _compile(function: F, **options: Any) -> F:
    if not (COMPILING or CALLABLE):
        return function
    from numba import njit
    from numba.core.cpu import CPUTargetOptions
    from numba.core.errors import NumbaExperimentalFeatureWarning
    from numba.core.options import TargetOptions

    # known to numba, but not to its decorators
    CPUTargetOptions.noalias = TargetOptions.Mapping("noalias")
    # a longer record may stand for a shorter one that it begins with: meant, and tested
    warnings.simplefilter("ignore", NumbaExperimentalFeatureWarning)
    compiled: Any = njit(error_model="numpy", fastmath=FLOAT_FLAGS, **options)(function)
    return compiled
