"""FILE_FORMAT.md is true: its code reads a history, its table is that of the code."""

import re
from pathlib import Path
from typing import Any

import numpy as np
from history_sample import FAMILIES, appended, sample_row, sample_time

from crashsolve.output import channels, layout, restart, states
from crashsolve.output.channels import Column, Family
from crashsolve.output.history import HistoryWriter
from crashsolve.output.log import ERROR, NORMAL, STOPPED

PAGE = Path(channels.__file__).parents[2] / "FILE_FORMAT.md"
TEXT = PAGE.read_text(encoding="utf-8")


def test_the_code_of_the_page_reads_a_running_and_a_finished_history(tmp_path: Path) -> None:
    code = re.search(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert code is not None
    page: dict[str, Any] = {}
    exec(code.group(1), page)
    path = tmp_path / "history.h5"
    writer = HistoryWriter(path, FAMILIES, {})
    for row in range(5):
        appended(writer, sample_time(row), sample_row(row))
    for finish in (writer.flush, writer.close):
        finish()
        times, values, unit = page["read"](path, "rbdout.wagon_b.velocity.x")
        np.testing.assert_array_equal(times, [sample_time(row) for row in range(5)])
        np.testing.assert_array_equal(values, 2.0 * np.arange(5))
        assert unit == "m/s"
        assert len(page["read"](path, "glstat.model.step")[0]) == 5


def test_the_page_finds_a_channel_among_the_types_of_a_family(tmp_path: Path) -> None:
    code = re.search(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert code is not None
    page: dict[str, Any] = {}
    exec(code.group(1), page)
    columns = (Column("force", "", "N", ""),)
    names = {"deforc-linear": ("stay", "strut"), "deforc-brake": ("shoe",)}
    families = tuple(Family(name, ids, columns) for name, ids in names.items())
    writer = HistoryWriter(tmp_path / "history.h5", families, {})
    appended(
        writer, 0.0, {"deforc-linear": np.array([[1.0], [2.0]]), "deforc-brake": np.ones((1, 1))}
    )
    writer.close()
    times, values, unit = page["read"](tmp_path / "history.h5", "deforc.strut.force")
    assert (times.tolist(), values.tolist(), unit) == ([0.0], [2.0], "N")


def test_families_are_those_of_the_code() -> None:
    table = TEXT.split("| family | holds |")[1].split("\n\n")[0]
    assert dict(re.findall(r"\| `(\w+)` \| (.*) \|", table)) == channels.FAMILIES


def test_versions_and_words_are_those_of_the_code() -> None:
    assert TEXT.startswith("# The results folder, format version 2 (states: 3)\n")
    assert [module.FORMAT_VERSION for module in (layout, restart, states)] == [2, 2, 3]
    for words in (layout.FORMAT, states.FORMAT, *restart.SLOTS, NORMAL, ERROR, STOPPED):
        assert words in TEXT
