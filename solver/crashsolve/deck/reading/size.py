"""Largest size of a model: the memory that its elements need, and that of this machine.

A bound before anything is allocated. Otherwise a slip of the pen ends in minutes of waiting, in the
system killing the process, or in a traceback.
"""

import os
import resource
from contextlib import suppress
from pathlib import Path

# [bytes] of an element with its nodes at the peak of a build: estimates, rather high than low
SHELL, BEAM = 5_000, 16_000
# nodes of beams are bodies with names: check takes 0.1 ms for each
MAX_BEAMS = 100_000


def machine_memory() -> float:
    """Memory that this process may use [bytes]."""
    bounds = [float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")]
    for name in ("memory.max", "memory/memory.limit_in_bytes"):
        # of a container, where there is one; "max" is none
        with suppress(OSError, ValueError):
            bounds.append(float(Path("/sys/fs/cgroup", name).read_text()))
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return min(bounds + ([float(limit)] if limit != resource.RLIM_INFINITY else []))


def shown_size(number: float) -> str:
    """A size in words."""
    return f"{number:.3g}" if number < 1e15 else "more than 1e15"


def excess(shells: int, beams: int) -> str:
    """Message that a model of so many elements is too large; empty where it is not."""
    if beams > MAX_BEAMS:
        return f"{shown_size(beams)} elements are too many, beams may have {MAX_BEAMS} in all"
    memory = machine_memory()
    if shells * SHELL + beams * BEAM <= memory:
        return ""
    needed = shown_size(shells * SHELL / 1e9)
    have = f"this machine has {memory / 1e9:.3g} GB"
    return f"{shown_size(shells)} elements need about {needed} GB of memory, and {have}"
