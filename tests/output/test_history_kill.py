"""A run killed at any moment leaves a history with every row of every finished flush."""

import os
import random
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from history_sample import FAMILIES, appended, assert_is_sample, read_rows, sample_row, sample_time
from quick import first_quick

from crashsolve.output import history
from crashsolve.output.history import HistoryWriter

ROWS_PER_FLUSH = 3


def in_child(work: Callable[[int], None]) -> tuple[int, int]:
    """Run `work(pipe)` in a forked process; returns its id and the reading end of the pipe."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            work(writing)
        finally:
            os._exit(1)
    os.close(writing)
    return child, reading


def rows_reported(pipe: int) -> int:
    """Number of rows the child said it had flushed, one byte for each flush."""
    with os.fdopen(pipe, "rb") as reader:
        return ROWS_PER_FLUSH * len(reader.read())


def append_for_ever(path: Path, pipe: int, flushes: int = 10**9) -> None:
    """Append rows, flush every third one and report it; the file is replaced again and again."""
    writer = HistoryWriter(path, FAMILIES, {})
    for flush in range(flushes):
        for row in range(ROWS_PER_FLUSH * flush, ROWS_PER_FLUSH * (flush + 1)):
            appended(writer, sample_time(row), sample_row(row))
        writer.flush()
        os.write(pipe, b".")
    writer.close()


@pytest.mark.long
def test_kill_at_random_moments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "history.h5"
    dice = random.Random(1989)
    samples = []
    for attempt in range(60):
        # half of the runs spend most of their time appending, half of it replacing the file
        monkeypatch.setattr(history, "FIRST_CAPACITY", 4 if attempt % 2 else 1024)
        path.unlink(missing_ok=True)
        child, pipe = in_child(lambda pipe: append_for_ever(path, pipe))
        # wait for some flushes, not for some time: a busy machine takes its own for them
        flushes = dice.randrange(1, 60)
        seen = 0
        while seen < flushes:
            seen += len(os.read(pipe, flushes - seen))
        time.sleep(dice.uniform(0.0, 2e-3))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        samples.append(assert_is_sample(path, rows_reported(pipe) + ROWS_PER_FLUSH * seen))
    assert len(set(samples)) > 10, "the kills did not fall at different moments"


@pytest.mark.parametrize("torn", first_quick([False, True]))
def test_kill_at_every_system_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, torn: bool
) -> None:
    """Stop before each call that changes a file in turn, or in the middle of each write."""
    monkeypatch.setattr(history, "FIRST_CAPACITY", 4)
    real = {name: getattr(os, name) for name in ("pwrite", "fdatasync", "fsync", "replace")}

    def stop_at(last: int) -> Callable[[int], None]:
        calls = [0]

        def counted(name: str) -> Callable[..., Any]:
            def call(*arguments: Any) -> Any:
                calls[0] += 1
                if calls[0] == last:
                    if torn and name == "pwrite":
                        file, data, offset = arguments
                        # doubles are aligned, so a write is cut between two of them
                        real["pwrite"](file, data[: len(data) // 16 * 8], offset)
                    os._exit(9)
                return real[name](*arguments)

            return call

        def work(pipe: int) -> None:
            for name in real:
                setattr(os, name, counted(name))
            append_for_ever(path, pipe, flushes=4)
            os._exit(0)

        return work

    path = tmp_path / "history.h5"
    for last in range(1, 1000):
        path.unlink(missing_ok=True)
        child, pipe = in_child(stop_at(last))
        _, status = os.waitpid(child, 0)
        reported = rows_reported(pipe)
        if reported or path.exists():
            assert_is_sample(path, reported)
        if os.waitstatus_to_exitcode(status) == 0:
            break
        assert os.waitstatus_to_exitcode(status) == 9
    else:
        pytest.fail("the child never came to its end")
    assert last > 30


def test_killed_history_is_resumed(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    child, pipe = in_child(lambda pipe: append_for_ever(path, pipe))
    while len(os.read(pipe, 1 << 16)) == 0:
        pass
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(pipe)
    with HistoryWriter(path, FAMILIES, {}, resume_time=sample_time(1)) as writer:
        appended(writer, sample_time(2), sample_row(2))
    assert assert_is_sample(path, 3) == 3


def test_reader_never_sees_half_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "FIRST_CAPACITY", 4)
    path = tmp_path / "history.h5"
    child, pipe = in_child(lambda pipe: append_for_ever(path, pipe))
    os.read(pipe, 1)
    lengths = [assert_is_sample(path, 3) for _ in range(30)]
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(pipe)
    assert lengths == sorted(lengths)
    assert lengths[-1] > lengths[0]


def test_every_dataset_is_aligned_to_its_doubles(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"
    HistoryWriter(path, FAMILIES, {"deck_text": "odd"}).flush()
    with h5py.File(path) as file:
        for family in FAMILIES:
            for name in ("time", *(column.path for column in family.columns)):
                assert file[family.name][name].id.get_offset() % 8 == 0
    assert np.size(read_rows(path)[0]) == 0
