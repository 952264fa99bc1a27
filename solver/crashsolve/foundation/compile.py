"""What a function is to the compiler, and the folder where compiled code is kept.

The decorators leave a function as it is and only mark it: Python runs it as it stands, and
translation/ reads its source. Compiled code lies in a folder named after a hash of every source
file of the package, so that no other sources can have made it.
"""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from crashsolve.foundation.cache import find_folder

F = TypeVar("F", bound=Callable[..., Any])

PACKAGE = Path(__file__).resolve().parent.parent


@cache
def cache_folder() -> Path:
    """Folder for composed steps and compiled code of exactly these sources. Raises CacheError."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return find_folder(digest.hexdigest()[:16])


def kernel(function: F) -> F:
    """Compile `function` for other compiled functions."""
    return _marked(function, "kernel")


def blockwise(function: F) -> F:
    """A kernel with loops over the lanes of a block, no two of whose tables and columns overlap.

    So nothing it writes is anything else that it reads, and the loops need no test for it.
    """
    return _marked(function, "blockwise")


def inlined(function: F) -> F:
    """A kernel that becomes part of its caller, so that literal sizes unroll its loops."""
    return _marked(function, "inlined")


def stage(function: F) -> F:
    """A stage of the step that has one caller, and becomes part of it."""
    return _marked(function, "stage")


def entry(function: F) -> F:
    """Compile a function of a number, a flag and tables, that machine.py hands to Python."""
    return _marked(function, "entry")


def _marked(function: F, how: str) -> F:
    function.compiled_as = how  # type: ignore[attr-defined]
    return function
