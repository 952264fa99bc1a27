"""Kernels as plain Python: nothing is compiled, every line is seen by coverage and debugger."""

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np


@cache
def plain(function: Any) -> Callable[..., Any]:
    """The Python function behind a kernel, calling the Python functions behind other kernels."""
    source = getattr(function, "py_func", function)
    bound = dict(source.__globals__)
    copy = FunctionType(source.__code__, bound, source.__name__, source.__defaults__)
    for name in source.__code__.co_names:
        value = bound.get(name)
        if hasattr(value, "py_func") or isinstance(value, FunctionType):
            bound[name] = plain(value)
    return copy


def records(count: int, record: Any) -> Any:
    """Zeroed table whose rows are read as in kernels: `table[i].name`."""
    return np.zeros(count, record.dtype).view(np.recarray)
