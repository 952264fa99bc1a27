"""Claim: kernels drawn at random have compiled the values that Python finds, or are refused."""

import random
from pathlib import Path

import numpy as np
import pytest

from crashsolve.compiler.machine import import_file, machine_code
from crashsolve.compiler.table import Tables

HEAD = """\
from crashsolve.foundation.kernels import entry, kernel

THREE = (5, -2, 3)

"""
WHOLE, REAL = ("i", "j", "n"), ("x", "y")
KERNELS, ROUNDS = 12, 6


class Draw:
    """Text of one kernel: integers stay far below 64 bits, so Python's have the same values."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def one(self, *words: str) -> str:
        return self.random.choice(words)

    def whole(self, depth: int = 2) -> str:
        """An expression of integers."""
        if depth == 0:
            return self.one(*WHOLE, str(self.random.randint(-9, 9)))
        a, b, c = self.whole(depth - 1), self.whole(depth - 1), self.whole(0)
        return self.one(
            f"({a} + {b})",
            f"({a} - {b})",
            f"({a} * {c})",
            f"({a} // {self.one('3', '-4', '-1')})",
            f"({a} % {self.one('5', '-7')})",
            f"(({a} % 64) << {self.random.randint(0, 5)})",
            f"({a} >> ({c} % 64))",
            f"({a} & {b})",
            f"({a} ^ {c})",
            f"abs({a})",
            f"max({a}, {b})",
            f"min({a}, {b}, {c})",
            f"({a} if {self.truth(depth - 1)} else {b})",
            f"THREE[{a} % 3]",
            f"int({self.real(0)})",
            f"-{c}" if c[0] != "-" else c,
        )

    def real(self, depth: int = 2) -> str:
        """An expression of quarters: exact in floating point numbers, in any order."""
        if depth == 0:
            return self.one(*REAL, "0.25", "-1.5", "float(i)")
        a, b = self.real(depth - 1), self.real(depth - 1)
        return self.one(
            f"({a} + {b})",
            f"({a} - {b})",
            f"({a} * {self.one('0.5', '2.0', '-1.0')})",
            f"({a} + {self.whole(0)})",
            f"abs({a})",
            f"max({a}, {b})",
            f"({a} if {self.truth(depth - 1)} else {b})",
        )

    def truth(self, depth: int = 1) -> str:
        """A condition."""
        if depth == 0:
            order = self.one("<", "<=", ">", ">=", "==", "!=")
            return f"({self.whole(0)} {order} {self.one(*WHOLE, *REAL)})"
        a, b = self.truth(depth - 1), self.truth(depth - 1)
        return self.one(f"({a} and {b})", f"({a} or {b})", f"(not {a})", f"bool({self.whole(1)})")

    def block(self, indent: str, depth: int, is_loop: bool = False) -> list[str]:
        """Some statements."""
        lines: list[str] = []
        for _ in range(self.random.randint(1, 3)):
            what = self.random.randint(0, 5 if depth else 2)
            if what == 0:
                lines.append(f"{self.one(*WHOLE)} = ({self.whole()}) % 1009")
            elif what == 1:
                lines.append(f"{self.one(*REAL)} = ({self.real()}) * 0.5 if x < 1000.0 else 0.25")
            elif what == 2:
                lines.append(f"i, j = j, ({self.whole(1)}) % 97")
            elif what == 3:
                lines += [f"if {self.truth()}:", *self.block("    ", depth - 1, is_loop)]
                lines += ["else:", *self.block("    ", depth - 1, is_loop)]
            else:
                steps = self.one("4", "n % 5", "1, 6, 2", "3, -3, -2")
                lines += [f"for k{depth} in range({steps}):"]
                lines += [f"    n = (n + k{depth}) % 1009", *self.block("    ", depth - 1, True)]
        if is_loop:
            lines += [f"if {self.truth()}:", f"    {self.one('break', 'continue')}"]
        return [indent + line for line in lines]

    def kernel(self, number: int) -> str:
        body = "\n".join(self.block("    ", 2))
        given = ", ".join((*WHOLE, *REAL))
        return f"@kernel\ndef drawn_{number}({given}):\n{body}\n    return {given}\n"


def source_of(seed: int) -> str:
    """A module: some kernels, and an entry that writes what they find."""
    draw = Draw(seed)
    parts = [draw.kernel(number) for number in range(KERNELS)]
    lines = ["@entry", "def work(number, flag, scene):", f"    for r in range({ROUNDS}):"]
    lines += [
        "        i, j, n = 7 * r - 9, 4 - 3 * r, r * r",
        "        x, y = 0.25 * r, number - r",
    ]
    for number in range(KERNELS):
        lines.append(f"        i, j, n, x, y = drawn_{number}(i, j, n, x, y)")
        for k, name in enumerate((*WHOLE, *REAL)):
            lines.append(f"        scene.out[{5 * number + k} + r * {5 * KERNELS}] = {name}")
    return HEAD + "\n\n".join([*parts, "\n".join(lines)]) + "\n"


def compare(seed: int, folder: Path) -> None:
    path = folder / f"kernels_at_random_{seed}.py"
    path.write_text(source_of(seed), "utf-8")
    outputs = [{"out": np.zeros(5 * KERNELS * ROUNDS)} for _ in range(2)]
    tables = [Tables(arrays) for arrays in outputs]
    machine_code(path, "work", tables[0])(2.75, True, tables[0])
    import_file(path).work(2.75, True, tables[1])
    np.testing.assert_array_equal(outputs[0]["out"], outputs[1]["out"], err_msg=str(path))


@pytest.mark.parametrize("seed", range(3))
def test_a_few_have_the_values_of_python(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path)


def test_they_have_them_where_bounds_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CRASHSOLVE_CHECKED", "1")
    compare(100, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(200, 260))
def test_many_have_the_values_of_python(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path)
