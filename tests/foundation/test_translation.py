"""Claim: a kernel does compiled what it does as plain Python, or is refused with file and line."""

import ast
import math
import re
from math import (
    acos,
    atan2,
    ceil,
    copysign,
    cos,
    exp,
    expm1,
    floor,
    log,
    log1p,
    sin,
    sqrt,
    tan,
    tanh,
)
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from crashsolve.compiler.machine import import_file, machine_code
from crashsolve.compiler.table import Tables
from crashsolve.compiler.translation.arithmetic import operate
from crashsolve.compiler.translation.expressions import BUILTINS, Expressions
from crashsolve.compiler.translation.kinds import Tuple, Value, known
from crashsolve.compiler.translation.memory import slot_of_number, write_number
from crashsolve.compiler.translation.module import Module, TranslationError
from crashsolve.foundation.kernels import entry, inlined, kernel, stage
from crashsolve.foundation.record import Record

ROW = Record("""
    width  m         a number
    mark   count     a whole number
    slot   m      3  several numbers
""")
WEIGHTS = (0.5, 0.25, 0.125)
PAIRS = ((1, 2.0), (3, 4.0), (5, 6.0))
ON, OFF = True, False


class Pair(NamedTuple):
    first: object
    second: object


@kernel
def rounded_down(i, j):
    """Quotients and rests with every sign."""
    return i // j, i % j, i // 3, i % 3, i // -3, i % -3, i // 2 % 5


@kernel
def of_kinds(i, x):
    """Whole and floating point numbers together."""
    total = 0
    for k in range(3):
        total += k
        if x > 0.5:
            total = total + x
    small = i if x > 0.0 else x
    return total, small, i / 2, i * x, -i, -x, i + True, min(i, x), max(x, i, 2), 2 * 3 - 7


@kernel
def first_of(x, i):
    """Returns of several kinds."""
    if x > 1.0:
        return 1, x
    if i > 2:
        return x, 2
    return 3.5, i


@kernel
def truths(i, x):
    """Every way to be true."""
    a = 0 < i < 5 and x < 1.0 or not x > -0.5
    b = bool(i and 1 <= i <= 3 != x)
    c = (i == 2) | (x > 0.0)
    d = 1 if i else 0
    return a, (1 if b else 0), c, d, i != 0, not i, x == x, x != x


@kernel
def loops(n, step):
    """Loops of every kind, and what their variables are afterwards."""
    up = down = odd = 0
    for k in range(n):
        if k == 1:
            continue
        if k == 6:
            break
        up = 10 * up + k
    last = -1
    for k in range(n, -n, step):
        down = (down * 7 + k) % 1000003
        last = k
    while True:
        odd += 1
        if odd % 2 == 1 and odd > n:
            break
    square = 1
    while square * square < n:
        square += 1
    k = n
    for part in (1.5, 2.5, n):
        if part == 2.5:
            continue
        k += part
    for i in range(2, 9, 3):
        for j in range(i):
            if j > 4:
                break
            square += i * j
    return up, down, last, odd, square, k


@kernel
def set_within(n):
    """A variable that a loop sets, of one kind here and of another there."""
    seen = 0
    for k in range(n):
        seen = k
        if k > 2:
            seen = 0.5 * k
    value = (n, n + 1)
    value = value[0] + 0.5
    for k in range(n):
        value = value + k
    return seen, value


@kernel
def tuples(k, x):
    """Items by number, parts, names, stars."""
    a = (x, 2.0 * x, 3.0 * x)
    first, *rest = (*a, k)
    pair = Pair(a, (k, x))
    i, y = PAIRS[k]
    (p, q, _), (r, _) = pair
    nested = (a, (1.0, 2.0, x))
    return (*a[:2], rest[-1]), pair.second[0], WEIGHTS[k], i + y, p + r, q, nested[k % 2][k], first


@kernel
def rates(x):
    """Functions of numbers; the library of C is that of Python."""
    y = abs(x) + 0.1
    return (
        (sqrt(y), sin(x), cos(x), exp(x), log(y), tan(x), tanh(x), expm1(x), log1p(y)),
        (acos(0.9 * sin(x)), atan2(x, -y), copysign(y, x), floor(x), ceil(x), int(3.0 * x)),
        (x**2, x**3, y**0.3, x**0, 2**5, math.fabs(x)),
    )


@kernel
def bits(i):
    """Whole numbers as bits."""
    return i << 3, i >> 1, i & 12, i | 5, i ^ 9, abs(i), -i


@inlined
def chosen(x, direction):
    """What there is of None is settled before the run."""
    if direction is None:
        return x
    return x + direction[0]


@stage
def rows(table, out, at):
    """Numbers to and from rows and columns. Writes: table, out."""
    for i in range(table.shape[0]):
        row = table[i]
        row.width, row.mark = row.mark, i
        row.slot[0], row.slot[1] = row.slot[1], row.slot[0]
        column = row.slot
        column[2] *= 2.0
        row.width += column[2]
    if ON and not OFF:
        at = keep(out, at, (chosen(1.0, None), chosen(1.0, (2.0,))))
    return at


def keep(out, at, values):
    """All numbers of a tuple, one after the other; returns where the next goes."""
    for value in values:
        if isinstance(value, tuple):
            at = keep(out, at, value)
        else:
            out[at] = value
            at += 1
    return at


def _keep(of: Expressions, given: list[Value]) -> Value:
    """What becomes of that, compiled."""
    out, at, values = given
    for item in values.items:
        if isinstance(item.kind, Tuple):
            at = _keep(of, [out, at, item])
        else:
            slot = slot_of_number(of.text, out, at)
            write_number(of.text, slot, np.dtype(float), item)
            at = operate(of.text, ast.Add(), at, known(1))
    return at


BUILTINS[keep] = _keep


@entry
def work(number, flag, scene):
    """All of it, for every pair of small numbers."""
    out, at = scene.out, 0
    for i in range(-4, 5):
        x = number * i + 0.3
        at = keep(out, at, (rounded_down(i, 2 if i < 0 else 3), rounded_down(i, i - 7)))
        at = keep(out, at, (of_kinds(i, x), first_of(x, i), truths(i, x), bits(i)))
        at = keep(out, at, (loops(i + 5, -2), loops(i + 5, -3), set_within(i + 5)))
        at = keep(out, at, (tuples((i + 4) % 3, x), rates(x)))
    at = rows(scene.table, out, at)
    out[at] = 1.0 if flag else 2.0
    scene.small[0] = at + 70000


def arrays() -> dict[str, np.ndarray]:
    table = np.zeros(5, ROW.dtype)
    table["width"], table["slot"] = np.arange(5) + 0.5, np.arange(15).reshape(5, 3)
    return {"table": table, "out": np.full(2000, np.nan), "small": np.zeros(1, np.int32)}


def test_compiled_kernels_equal_plain_python() -> None:
    compiled, plain = arrays(), arrays()
    tables = Tables(compiled)
    machine_code(Path(__file__), "work", tables)(0.37, True, tables)
    work(0.37, True, Tables(plain))
    count = int(plain["small"][0]) - 70000
    assert 700 < count < 2000
    for name in ("table", "small"):
        assert compiled[name].tobytes() == plain[name].tobytes(), name
    # functions of numbers are another library's, and sums may be contracted: a few last bits
    np.testing.assert_allclose(compiled["out"], plain["out"], rtol=1e-14, atol=1e-15)


WRONG = {
    "a list": ("x = [number]", "kernels have no List"),
    "a name from nowhere": ("x = missing + 1", "unknown name `missing`"),
    "no such table": ("x = scene.nothing", "the scene has no table `nothing`"),
    "no such column": ("x = scene.table[0].mass", "these rows have no column `mass`, but "),
    "an index that is no integer": ("x = scene.out[number]", "an index must be an integer"),
    "one kind or another": ("x = 1 if flag else (1, 2)", "must be of one kind"),
    "a variable of two kinds": (
        "x = 1\n    if flag:\n        x = (1, 2)\n    y = x",
        "`x` is not of one kind here",
    ),
    "not set yet": ("y = x\n    x = 1", "`x` has no value yet"),
    "beyond the end": ("x = (1, 2)[2]", "a tuple of 2 has no item 2"),
    "items of several kinds": ("x = (1, (2, 3))[scene.small[0]]", "must be of one kind"),
    "no kernel": ("x = bare(number)", "bare is no kernel"),
    "calls itself": ("x = infinite(number)", "infinite calls itself"),
    "too many arguments": ("x = twice(1, 2)", "twice takes 1, not 2"),
    "names": ("x, y = (1, 2, 3)", "3 values for 2 names"),
    "keywords": ("x = twice(x=1.0)", "arguments by position"),
    "a whole row": ("scene.table[0] = 1.0", "kernels write numbers"),
    "an unknown word": ("del number", "kernels have no Delete"),
    "a text": ("x = 'word'", "a kernel cannot use 'word'"),
    "in": ("x = 1 in (1, 2)", "kernels do not compare with In"),
    # what would have another value than in Python
    "or as a value": ("x = number or 0.5", "as a value `and` or `or` of numbers"),
    "and as a value": ("x = flag and number", "as a value `and` or `or` of numbers"),
    "or of a tuple": ("x = (1, 2) or (3, 4)", "as a value `and` or `or` of numbers"),
    "or within an argument": ("x = twice(number or 2.0)", "as a value `and` or `or` of numbers"),
    "or that is compared": ("x = 1 if (number or 2.0) > 1.0 else 0", "as a value `and` or `or`"),
    "one branch alone": ("if flag:\n        x = 1\n    y = x", "`x` may have no value here"),
    "the other branch": (
        "if flag:\n        y = 1\n    else:\n        x = 1\n    y = x",
        "`x` may have no value here",
    ),
    "a loop alone": (
        "for k in range(scene.small[0]):\n        x = k\n    y = x",
        "`x` may have no value here",
    ),
    "a loop's own variable": (
        "for k in range(int(number)):\n        pass\n    y = k",
        "`k` may have no value here",
    ),
    "a while loop alone": (
        "while number > 1.0:\n        x = 1\n        number = 0.0\n    y = x",
        "`x` may have no value here",
    ),
    "set before the break": (
        "for k in range(5):\n        if flag:\n            break\n        x = k\n    y = x",
        "`x` may have no value here",
    ),
    "beyond a column": ("scene.table[0].slot[3] = 1.0", "of 3 numbers has no item 3"),
    "beyond a column, read": ("x = scene.table[0].slot[1 + 3]", "of 3 numbers has no item 4"),
    "before a column": ("x = scene.table[0].slot[-1]", "no item -1"),
    "before a vector": ("scene.out[-1] = 1.0", "no item -1"),
    "before a table": ("x = scene.table[-1].width", "no row -1"),
    "a large constant": ("x = 2**70 + scene.small[0]", "beyond 64 bits"),
    "a large sum": ("x = (2**63 - 1) + 1", "beyond 64 bits"),
    "a large literal": ("x = 9223372036854775808", "beyond 64 bits"),
    "a large constant in a column": ("scene.small[0] = 2**31", "of 32 bits cannot hold"),
    "shifted far": ("x = scene.small[0] << 64", "no shift by 64"),
    "shifted back": ("x = scene.small[0] >> -1", "no shift by -1"),
    "divided by zero": ("x = scene.small[0] // 0", "division of an integer by zero"),
    "the rest by zero": ("x = scene.small[0] % 0", "division of an integer by zero"),
    "an integer of nan": ("x = int(NAN)", "nan is no integer"),
    "max of nothing": ("x = max()", "max and min take numbers"),
    "max of one number": ("x = max(1.0)", "max and min take numbers"),
    "max of an empty tuple": ("x = max(())", "max and min take numbers"),
    "range of nothing": ("for k in range():\n        pass", "range takes one to three"),
    "range of four": ("for k in range(1, 2, 3, 4):\n        pass", "range takes one to three"),
    "range that stands": ("for k in range(1, 2, 0):\n        pass", "no step of 0"),
    "floor of nothing": ("x = floor()", "floor takes 1 argument"),
    "int of nothing": ("x = int()", "int takes 1 argument"),
    "float of two": ("x = float(1, 2)", "float takes 1 argument"),
    "bool of nothing": ("x = bool()", "bool takes 1 argument"),
    "abs of nothing": ("x = abs()", "abs takes 1 argument"),
}
HEAD = """\
from math import floor

from crashsolve.foundation.kernels import entry, kernel

NAN = float("nan")

def bare(x):
    return x

@kernel
def twice(x):
    return 2 * x

@kernel
def infinite(x):
    return infinite(x)

@entry
def work(number, flag, scene):
"""


@pytest.mark.parametrize("name", WRONG)
def test_other_constructs_are_refused_with_file_and_line(name: str, tmp_path: Path) -> None:
    lines, why = WRONG[name]
    source = tmp_path / f"wrong_{len(name)}_{abs(hash(name))}.py"
    source.write_text(f"{HEAD}    {lines}\n", "utf-8")
    module = Module(Tables(arrays()).slots)
    with pytest.raises(TranslationError, match=rf"{source.name}:\d+: .*{re.escape(why)}"):
        module.entry(import_file(source).work, "work")


def test_a_scene_has_the_same_text_every_time() -> None:
    texts = []
    for _ in range(2):
        module = Module(Tables(arrays()).slots)
        module.entry(work, "work")
        texts.append(module.units())
    assert texts[0] == texts[1]
