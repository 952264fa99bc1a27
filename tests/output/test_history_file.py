"""history.h5: what is appended is what is read, now, while running and after a restart."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from history_sample import FAMILIES, appended, assert_is_sample, read_rows, sample_row, sample_time

from crashsolve.output import layout
from crashsolve.output.channels import Column, Family
from crashsolve.output.errors import OutputError
from crashsolve.output.history import HistoryWriter


def write_sample(path: Path, rows: int, **options: Any) -> HistoryWriter:
    """Append the first rows of the sample and leave the writer open."""
    writer = HistoryWriter(path, FAMILIES, {}, **options)
    for row in range(rows):
        appended(writer, sample_time(row), sample_row(row))
    return writer


@pytest.mark.parametrize("rows", [0, 1, 7, 1024, 1025, 2500])
def test_a_closed_file_holds_every_row_and_no_more(tmp_path: Path, rows: int) -> None:
    path = tmp_path / "history.h5"
    write_sample(path, rows).close()
    assert assert_is_sample(path, rows) == rows
    with h5py.File(path) as file:
        assert file["rbdout/position/x"].shape == (rows, 3)


def test_a_run_that_may_last_for_ever_reserves_little(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    with HistoryWriter(path, FAMILIES, {}, expected_rows=10**12):
        # 2^20 rows of times, and a page for each of the few columns, whose rows no disk has yet
        assert 512 * path.stat().st_blocks < 8 * 2**20 + 2**20


def test_a_run_of_many_channels_reserves_no_more_than_a_quarter_of_a_gigabyte(
    tmp_path: Path,
) -> None:
    path, names = tmp_path / "history.h5", tuple(f"b{k}" for k in range(2000))
    family = Family("rbdout", names, (Column("speed", "", "m/s", "of the body"),))
    with HistoryWriter(path, (family,), {}, expected_rows=10**12):
        assert path.stat().st_size < 2**28 + 2**20


def test_rows_are_readable_while_the_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    writer = write_sample(path, 5)
    assert len(read_rows(path)[0]) == 0
    writer.flush()
    with h5py.File(path) as reader:
        # a reader who holds the file neither blocks the run nor is disturbed by it
        appended(writer, sample_time(5), sample_row(5))
        writer.close()
        assert reader["glstat/time"][4] == sample_time(4)
    assert assert_is_sample(path, 6) == 6


def test_rows_are_flushed_after_the_given_wall_time(tmp_path: Path) -> None:
    writer = write_sample(tmp_path / "history.h5", 3, flush_seconds=0.0)
    assert assert_is_sample(tmp_path / "history.h5", 3) == 3
    writer.close()


def test_families_share_one_time_axis_and_are_described(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    unused = Family("rcforc", (), (Column("force", "x", "N", ""),))
    with HistoryWriter(path, (*FAMILIES, unused), {}) as writer:
        appended(writer, 0.0, sample_row(0))
    with h5py.File(path) as file:
        assert sorted(file) == ["glstat", "rbdout"]
        assert file["glstat/time"] == file["rbdout/time"]
        assert list(file["rbdout/ids"].asstr()) == list(FAMILIES[1].ids)
        assert file["rbdout/position/x"].attrs["unit"] == "m"
        assert file["rbdout/position/x"].attrs["meaning"] == "mass centre"
        assert file["rbdout"].attrs["meaning"] == "motion of rigid bodies and of nodes of parts"


def test_metadata_may_be_long_and_structured(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    deck, expect = "größe: 1\n" * 20_000, [{"channel": "glstat.model.step", "value": 1e-5}]
    with HistoryWriter(path, FAMILIES, {"deck_text": deck, "expect": expect, "cores": 2}) as writer:
        appended(writer, 0.0, sample_row(0))
    with h5py.File(path) as file:
        assert file.attrs["format"] == "crashsolve history"
        assert file.attrs["format_version"] == 2
        assert file.attrs["deck_text"] == deck
        assert json.loads(file.attrs["expect"]) == expect
        assert file.attrs["cores"] == 2


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_row_that_is_not_finite_is_refused_and_leaves_no_trace(
    tmp_path: Path, value: float
) -> None:
    path = tmp_path / "history.h5"
    writer = write_sample(path, 4)
    broken = sample_row(4)
    broken["rbdout"][2, 1] = value
    with pytest.raises(OutputError, match=r"rbdout\.wagon_c\.velocity\.x is -?(nan|inf)") as caught:
        appended(writer, sample_time(4), broken)
    assert caught.value.exit_code == 5
    writer.close()
    assert assert_is_sample(path, 4) == 4


@pytest.mark.parametrize("time", [0.003, 0.0, np.nan, np.inf])
def test_time_must_go_forward(tmp_path: Path, time: float) -> None:
    writer = write_sample(tmp_path / "history.h5", 4)
    with pytest.raises(OutputError, match="follows"):
        appended(writer, time, sample_row(4))


def test_wrong_shape_is_refused(tmp_path: Path) -> None:
    writer = write_sample(tmp_path / "history.h5", 0)
    with pytest.raises(ValueError, match="glstat"):
        appended(writer, 0.0, {**sample_row(0), "glstat": np.zeros((3, 1))})


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("kept", [1, 700, 1500, 2000])
def test_resumed_history_equals_the_uninterrupted_one(
    tmp_path: Path, kept: int, closed: bool
) -> None:
    path = tmp_path / "history.h5"
    first = write_sample(path, 2000)
    first.close() if closed else first.flush()
    writer = HistoryWriter(path, FAMILIES, {}, resume_time=sample_time(kept - 1))
    assert assert_is_sample(path, kept) == kept
    for row in range(kept, 2100):
        appended(writer, sample_time(row), sample_row(row))
    writer.close()
    assert assert_is_sample(path, 2100) == 2100
    whole = write_sample(tmp_path / "whole.h5", 2100)
    whole.close()
    assert path.read_bytes() == (tmp_path / "whole.h5").read_bytes()
    for name in ("least", "greatest", "least_time", "greatest_time"):
        for first, second in zip(
            getattr(writer.extremes, name), getattr(whole.extremes, name), strict=True
        ):
            np.testing.assert_array_equal(first, second)


def test_history_of_another_model_is_not_resumed(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    write_sample(path, 3).close()
    renamed = Family("rbdout", ("wagon_a", "wagon_b", "wagon_d"), FAMILIES[1].columns)
    fewer = Family("rbdout", FAMILIES[1].ids, FAMILIES[1].columns[:1])
    for families, reason in (
        ((FAMILIES[0], renamed), "'rbdout' have changed"),
        ((FAMILIES[0], fewer), "'rbdout' have changed"),
        (FAMILIES[:1], "families"),
    ):
        with pytest.raises(OutputError, match=reason):
            HistoryWriter(path, families, {}, resume_time=0.0)
    assert assert_is_sample(path, 3) == 3


def test_missing_history_is_not_resumed(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"history\.h5"):
        HistoryWriter(tmp_path / "history.h5", FAMILIES, {}, resume_time=0.0)


def test_cost_of_appending_does_not_grow_with_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copied: list[int] = []
    real_copy = layout.copy_rows

    def counted(*what: Any) -> None:
        copied.append(what[-1])
        real_copy(*what)

    monkeypatch.setattr(layout, "copy_rows", counted)
    write_sample(tmp_path / "history.h5", 20_000).close()
    # doubling: 1024 + 2048 + ... and the last copy, which trims
    assert sum(copied) < 3 * 20_000


def test_a_file_that_grows_to_what_is_expected_is_not_copied_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # room for the first rows alone, so that the file has to grow
    monkeypatch.setattr("crashsolve.output.history.MAX_RESERVED_BYTES", 4096)
    path, expected = tmp_path / "history.h5", 700
    writer = write_sample(path, expected, expected_rows=expected)
    writer.flush()
    before = path.stat().st_ino
    with h5py.File(path) as file:
        assert len(file["glstat/time"]) == expected
    writer.close()
    assert path.stat().st_ino == before
    assert assert_is_sample(path, expected) == expected
