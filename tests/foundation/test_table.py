"""Claim: a compiled kernel sees the same numbers through tables as numpy does in its arrays."""

from pathlib import Path

import numpy as np
import pytest

from crashsolve.compiler.machine import CompileError, machine_code
from crashsolve.compiler.table import Tables
from crashsolve.foundation.kernels import entry
from crashsolve.foundation.record import Record

THING = Record("""
    mass   kg        a number
    slot   m      3  several numbers
    mark   count     a whole number
    marks  count  2  several whole numbers
""")


@entry
def work(number, flag, scene):
    """Read and write everything that a table offers."""
    things, pages, sums = scene.things, scene.pages, scene.sums
    for i in range(things.shape[0]):
        thing = things[i]
        thing.mass *= 2.0
        thing.slot[1] = thing.slot[0] + 10.0 * thing.slot[2]
        thing.slot[2] -= 1.0
        thing.mark += thing.marks[0]
        thing.marks[1] = i
        sums[0] += thing.mass
    page = pages[1]
    for i in range(pages.shape[1]):
        page[i].mass = pages[0, i].mass + 1.0
        pages[0, i].mark = 7
    sums[1] = things.shape[0] + page.shape[0] + 100 * pages.shape[0]
    if flag:
        sums[1] += number


def arrays() -> dict[str, np.ndarray]:
    things, pages = np.zeros(4, THING.dtype), np.zeros((2, 3), THING.dtype)
    things["mass"], things["marks"] = [1, 2, 3, 4], 5
    things["slot"] = np.arange(12).reshape(4, 3)
    pages["mass"][0] = [10, 20, 30]
    return {"things": things, "pages": pages, "sums": np.zeros(2)}


def test_a_compiled_kernel_equals_plain_python(tmp_path: Path) -> None:
    compiled, plain = arrays(), arrays()
    tables = Tables(compiled)
    machine_code(Path(__file__), "work", tables)(3.0, True, tables)
    work(3.0, True, Tables(plain))
    for name in plain:
        assert compiled[name].tobytes() == plain[name].tobytes(), name
    # and both did something: 2 (1 + 2 + 3 + 4), then 4 + 3 + 200 + 3
    assert list(plain["sums"]) == [20.0, 210.0]
    assert list(plain["pages"]["mass"][1]) == [11, 21, 31]
    assert list(plain["things"]["marks"][:, 1]) == [0, 1, 2, 3]


def test_the_layout_depends_on_names_and_columns_alone() -> None:
    one, same, other = Tables(arrays()), Tables(arrays()), arrays()
    other["things"] = np.zeros(9, THING.dtype)
    assert one.layout == same.layout == Tables(other).layout
    other["more"] = np.zeros(3)
    assert one.layout != Tables(other).layout


def test_what_cannot_be_compiled_is_reported(tmp_path: Path) -> None:
    source = tmp_path / "wrong.py"
    source.write_text(
        "from crashsolve.foundation.kernels import entry\n\n\n"
        "@entry\ndef work(number, flag, tables):\n    tables.nothing[0] = 1.0\n"
    )
    with pytest.raises(CompileError, match="(?s)cannot compile .*wrong.py.*nothing"):
        machine_code(source, "work", Tables(arrays()))


def test_an_array_in_pieces_is_refused() -> None:
    with pytest.raises(ValueError, match="must lie in one piece"):
        Tables({"things": np.zeros(6, THING.dtype)[::2]})


@pytest.mark.parametrize("name", ["addresses", "slots", "pointer", "of_threads", "layout"])
def test_the_table_of_tables_may_not_be_hidden(name: str) -> None:
    with pytest.raises(ValueError, match=f"no table may be called {name}"):
        Tables({name: np.zeros(3)})
