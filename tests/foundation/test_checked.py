"""Claim: in checked mode a kernel that leaves a bound stops, with file, line, name and index."""

import re
from pathlib import Path

import numpy as np
import pytest

from crashsolve.compiler.machine import BoundsError, machine_code
from crashsolve.compiler.table import Tables
from crashsolve.foundation.kernels import entry, kernel
from crashsolve.foundation.record import Record

ROW = Record("""
    mark  count     a whole number
    slot  m      3  several numbers
""")
THREE = (1.0, 2.0, 4.0)


@kernel
def added(column, first, count):
    """The sum of some numbers of a column of any length."""
    total = 0.0
    for k in range(first, first + count):
        total += column[k]
    return total


@entry
def work(number, flag, scene):
    """One access of every kind, by the indices that the test gives."""
    at = scene.at
    scene.out[at[0]] = 1.0
    scene.rows[at[1]].slot[at[2]] = 2.0
    scene.out[0] += scene.grid[at[3], at[4]].slot[2]
    scene.out[0] += THREE[at[5]]
    scene.out[0] += added(scene.rows[0].slot, at[6], 2) + added(scene.out, at[7], 2)
    scene.small[0] = 2 * at[8]
    scene.out[1] = 7 // at[9] + (1 << at[10]) + int(number * at[11])


# the index that is wrong, its value, the limit, and the expression that is named
WRONG = [
    (0, 4, 4, "`scene.out[at[0]]`"),
    (0, -1, 4, "`scene.out[at[0]]`"),
    (0, 2**40, 4, "`scene.out[at[0]]`"),
    (1, 5, 5, "`scene.rows[at[1]]`"),
    (1, -2, 5, "`scene.rows[at[1]]`"),
    (2, 3, 3, "`scene.rows[at[1]].slot[at[2]]`"),
    (3, 2, 2, "`scene.grid[at[3], at[4]]`"),
    (4, 3, 3, "`scene.grid[at[3], at[4]]`"),
    (5, 3, 3, "`THREE[at[5]]`"),
    (5, -1, 3, "`THREE[at[5]]`"),
    (6, 2, 3, "added: `column[k]`"),
    (7, 3, 4, "added: `column[k]`"),
    (8, 2**30, 2**31, "`scene.small[0]`"),
    (9, 0, 0, "`7 // at[9]`"),
    (10, 64, 64, "`1 << at[10]`"),
    (11, 2**62, 2**63 - 1, "`int(number * at[11])`"),
]
RIGHT = (3, 4, 2, 1, 2, 2, 1, 2, 2**29, -3, 63, 1)


def arrays(at: list[int]) -> dict[str, np.ndarray]:
    return {
        "at": np.array(at),
        "out": np.zeros(4),
        "rows": np.zeros(5, ROW.dtype),
        "grid": np.zeros((2, 3), ROW.dtype),
        "small": np.zeros(1, np.int32),
    }


def run(at: list[int]) -> dict[str, np.ndarray]:
    data = arrays(at)
    tables = Tables(data)
    machine_code(Path(__file__), "work", tables)(4.5, True, tables)
    return data


@pytest.fixture(autouse=True)
def _checked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRASHSOLVE_CHECKED", "1")


def test_what_stays_within_its_bounds_has_the_bits_of_the_usual_mode(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    checked = run(list(RIGHT))
    monkeypatch.setenv("CRASHSOLVE_CHECKED", "0")
    usual = run(list(RIGHT))
    assert checked["out"][3] == 1.0 and checked["small"][0] == 2**30
    for name, array in usual.items():
        assert array.tobytes() == checked[name].tobytes(), name


@pytest.mark.parametrize(("which", "value", "limit", "named"), WRONG)
def test_what_leaves_them_is_named(which: int, value: int, limit: int, named: str) -> None:
    at = list(RIGHT)
    at[which] = value
    # a sum over a column starts at the index, and leaves it one later
    wrong = {6: 3, 7: 4, 8: 2**31, 9: 7, 11: 2**63 - 1}.get(which, value)
    said = rf"test_checked\.py:\d+: .*{re.escape(named)}.*: {wrong} .*limit is {limit}$"
    with pytest.raises(BoundsError, match=said):
        run(at)


def test_the_next_call_after_a_failure_is_judged_for_itself() -> None:
    at = list(RIGHT)
    at[1] = 9
    with pytest.raises(BoundsError):
        run(at)
    run(list(RIGHT))
