"""Marks that state how the compiler treats a function.

The decorators leave a function as it is and only mark it: Python runs it as it stands, and
compiler/translation/ reads its source.
"""

from collections.abc import Callable
from typing import TypeVar

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` for other compiled functions."""
    return _marked(function, "kernel")


def apart(function: F) -> F:
    """A kernel that several threads may share: it is never inlined.

    So it has the same code, and bits, for every caller.
    """
    return _marked(function, "apart")


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
    """Compile a function of a number, a flag and tables, which machine.py makes callable from
    Python.
    """
    return _marked(function, "entry")


def _marked(function: F, how: str) -> F:
    function.compiled_as = how  # type: ignore[attr-defined]
    return function
