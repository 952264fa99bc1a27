"""Claim: pages of a library that are given back leave memory, and come again when asked for."""

from pathlib import Path

import llvmlite.binding as llvm
import pytest

from crashsolve.compiler.machine import forget_linker

SMAPS = Path("/proc/self/smaps")
TEXT = "define i32 @f() { ret i32 7 }"


def resident() -> int:
    """Memory that LLVM's library takes [kB]."""
    total, is_own = 0, False
    for line in SMAPS.read_text("utf-8").splitlines():
        if not line.partition(" ")[0].endswith(":"):
            is_own = "libllvmlite" in line
        elif is_own and line.startswith("Rss:"):
            total += int(line.split()[1])
    return total


@pytest.mark.skipif(not SMAPS.exists(), reason="no list of pages")
def test_the_linker_is_forgotten_and_works_on() -> None:
    assert llvm.parse_assembly(TEXT).get_function("f").name == "f"
    before = resident()
    forget_linker()
    # what is left has addresses put in, 2 MB of 180
    assert resident() < 3_000 < before
    assert llvm.parse_assembly(TEXT).get_function("f").name == "f"
