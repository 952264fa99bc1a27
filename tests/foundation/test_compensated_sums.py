"""Claim: compensated sums are compiled as they stand, and have the bits of plain Python.

Round-off that a compiler takes for nothing is all that they consist of: `(a + b) - a` is not b.
"""

from math import fsum
from pathlib import Path

import numpy as np
import pytest

from crashsolve.compiler.machine import machine_code
from crashsolve.compiler.table import Tables
from crashsolve.foundation.kernels import blockwise, entry, inlined, kernel

COUNT = 999


@kernel
def kahan(x):
    """Sum of a column by Kahan's algorithm."""
    total, rest = 0.0, 0.0
    for k in range(COUNT):
        y = x[k] - rest
        then = total + y
        rest = (then - total) - y
        total = then
    return total


@inlined
def two_sum(a, b):
    """a + b, and its rounding error exactly (Knuth)."""
    s = a + b
    b_kept = s - a
    return s, (a - (s - b_kept)) + (b - b_kept)


@kernel
def twofold(x):
    """Sum of a column, and of the errors of its steps."""
    total, errors = 0.0, 0.0
    for k in range(COUNT):
        total, error = two_sum(total, x[k])
        errors += error
    return total, errors


@kernel
def in_order(x):
    """The plain sum, from the first to the last."""
    total = 0.0
    for k in range(COUNT):
        total += x[k]
    return total


@blockwise
def of_a_block(x, out):
    """A kernel that may sum in any order calls those that may not. Writes: out."""
    out[4], (out[5], out[6]) = kahan(x), twofold(x)


@entry
def work(number, flag, scene):
    out, x = scene.out, scene.x
    out[0], (out[1], out[2]), out[3] = kahan(x), twofold(x), in_order(x)
    of_a_block(x, out)


def arrays(name: str) -> dict[str, np.ndarray]:
    """A column of numbers from 1e-8 to 1e8 of both signs; `lanes` turns on vector instructions."""
    rng = np.random.default_rng(5)
    x = rng.choice([-1.0, 1.0], COUNT) * 10.0 ** rng.uniform(-8.0, 8.0, COUNT)
    return {"x": x, "out": np.zeros(7), name: np.zeros(16)}


@pytest.mark.parametrize("name", ["lanes", "other"])
def test_they_have_the_bits_of_plain_python(name: str) -> None:
    compiled, plain = arrays(name), arrays(name)
    tables = Tables(compiled)
    machine_code(Path(__file__), "work", tables)(0.0, False, tables)
    work(0.0, False, Tables(plain))
    out, x = compiled["out"], compiled["x"]
    assert out.tobytes() == plain["out"].tobytes()
    # they are more exact than the plain sum: one rounding, where it has COUNT of numbers of 1e8
    exact = fsum(x)
    assert abs(out[3] - exact) > 1e-8
    assert abs(out[1] + out[2] - exact) < 1e-9 and abs(out[0] - exact) < abs(out[3] - exact)
