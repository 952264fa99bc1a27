"""Memory by its address: for calls between compiled functions, and copies of tables.

The compiled step of a scene and the tables it is called with are known at run time alone, so that
its caller (`recording/march.py`) is compiled once for all scenes. Addresses are whole numbers.
Plain Python runs these; `translation/addresses.py` compiles them.
"""

import ctypes
from time import perf_counter_ns


def call_step(step, number, flag, tables):
    """Call the entry at `step` with a number, a flag and the address of its tables."""
    ctypes.CFUNCTYPE(None, ctypes.c_double, ctypes.c_bool, ctypes.c_void_p)(step)(
        number, flag, tables
    )


def copy_bytes(target, source, count):
    """Copy so many bytes between pieces of memory that do not overlap."""
    # plain Python has numbers of numpy here
    ctypes.memmove(int(target), int(source), int(count))


def number_at(address):
    """The floating point number that lies there."""
    return ctypes.c_double.from_address(int(address)).value


def ticks():
    """A clock of unknown unit that costs nothing to read; 0 on processors without one."""
    return perf_counter_ns()
