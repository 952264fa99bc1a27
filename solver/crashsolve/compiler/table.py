"""Tables: the arrays of a scene under their names, as compiled code gets them, in one argument.

A structured array of one or two dimensions becomes a table of rows, a plain one of one dimension a
column of numbers; translation/memory.py states the operations of kernels on them.
"""

import hashlib
from copy import copy
from typing import Any

import numpy as np

from crashsolve.foundation.rows import as_rows

WORDS = 3  # of a table in memory: address, and lengths of two dimensions
Slot = tuple[np.dtype, int]  # layout of a row, and dimensions


class Tables:
    """Arrays by name; as attributes they are Rows, for kernels that run as plain Python.

    Raises: ValueError for an array that does not lie in one piece, or whose name means another
    thing here.
    """

    def __init__(self, arrays: dict[str, np.ndarray]) -> None:
        self.addresses = np.zeros((len(arrays), WORDS), np.int64)
        self.slots: dict[str, Slot] = {}
        # compiled code has their addresses alone: they must last as long
        self._arrays = dict(arrays)
        # the address of all of them, and the tables of other threads, which have some of their own
        self.pointer = self.addresses.ctypes.data
        self.of_threads: list[Tables] = []
        for address, (name, array) in zip(self.addresses, arrays.items(), strict=True):
            if name in self.__dict__ or hasattr(type(self), name):
                raise ValueError(f"no table may be called {name}")
            _point(address, name, array)
            self.slots[name] = (array.dtype, array.ndim)

    def replaced(self, arrays: dict[str, np.ndarray]) -> "Tables":
        """These tables with other arrays in place of some, of the same layout."""
        tables = copy(self)
        tables.addresses = self.addresses.copy()
        tables.pointer = tables.addresses.ctypes.data
        tables._arrays = self._arrays | arrays
        for address, name in zip(tables.addresses, self.slots, strict=True):
            tables.__dict__.pop(name, None)
            if name in arrays:
                _point(address, name, arrays[name])
        return tables

    def __getattr__(self, name: str) -> Any:
        """A table as Rows, made when it is first asked for: compiled code asks for none."""
        array = self.__dict__.get("_arrays", {}).get(name)
        if array is None:
            raise AttributeError(f"there is no table {name}")
        setattr(self, name, as_rows(array))
        return self.__dict__[name]

    @property
    def layout(self) -> str:
        """Names and columns of all tables, in a word: equal for scenes that share compiled code."""
        return layout_of(self.slots)


def layout_of(slots: dict[str, Slot]) -> str:
    """A word for the names and columns of tables."""
    text = repr([(name, t.descr, ndim) for name, (t, ndim) in slots.items()])
    return hashlib.sha1(text.encode()).hexdigest()[:16]


def _point(address: np.ndarray, name: str, array: np.ndarray) -> None:
    """Write where an array lies, and how long it is. Writes: address."""
    if not array.flags.c_contiguous:
        raise ValueError(f"table {name} must lie in one piece")
    address[0] = array.ctypes.data
    address[1 : 1 + array.ndim] = array.shape
