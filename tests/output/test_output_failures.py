"""A full disk or a missing folder ends in an OutputError that names file and reason."""

import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from history_sample import FAMILIES, appended, assert_is_sample, sample_row, sample_time

from crashsolve.output import shapes
from crashsolve.output.blocks import Block
from crashsolve.output.errors import OutputError
from crashsolve.output.files import replace_text
from crashsolve.output.history import HistoryWriter
from crashsolve.output.log import Log
from crashsolve.output.restart import newest_restart, write_restart
from crashsolve.output.states import StateWriter

LIMIT = 100_000


def outcome_with_limit(work: Callable[[], None]) -> str:
    """Run in a child whose files may not pass LIMIT bytes; returns its OutputError."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT))
        try:
            work()
        except OutputError as error:
            os.write(writing, str(error).encode())
        finally:
            os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    with os.fdopen(reading) as reader:
        return reader.read()


def test_history_keeps_its_rows_when_the_disk_is_full(tmp_path: Path) -> None:
    path = tmp_path / "history.h5"

    def fill() -> None:
        with HistoryWriter(path, FAMILIES, {}) as writer:
            for row in range(10**6):
                appended(writer, sample_time(row), sample_row(row))

    assert outcome_with_limit(fill) == f"{path}: File too large"
    assert assert_is_sample(path, 500) < 2000
    assert os.listdir(tmp_path) == ["history.h5"]


def test_last_restart_dump_survives_a_full_disk(tmp_path: Path) -> None:
    def fill() -> None:
        for number in range(3, 30):
            write_restart(tmp_path, {"x": np.zeros(1000 * number)}, {"number": number})

    assert outcome_with_limit(fill).endswith(".h5: File too large")
    dump = newest_restart(tmp_path)
    assert dump is not None
    assert dump[0]["x"].size == 1000 * dump[1]["number"]


def test_states_report_a_full_disk(tmp_path: Path) -> None:
    points = np.zeros((LIMIT // 12, 3))
    block = Block("b", points, (("vertex", np.zeros((1, 1), int)),))
    reason = outcome_with_limit(lambda: None if StateWriter(tmp_path, (block,), {}) else None)
    assert reason == f"{tmp_path / 'mesh.h5'}: File too large"


def test_log_reports_a_full_disk(tmp_path: Path) -> None:
    def fill() -> None:
        log = Log(tmp_path / "log.txt", open(os.devnull, "w"))  # noqa: SIM115
        for _ in range(LIMIT):
            log.line("x" * 100)

    assert outcome_with_limit(fill) == f"{tmp_path / 'log.txt'}: File too large"


def test_folder_that_does_not_exist_is_named(tmp_path: Path) -> None:
    missing = tmp_path / "missing"
    points, triangles = shapes.plane(1.0)
    block = Block("road", points, (("triangle", triangles),))
    (tmp_path / "file").write_text("")
    for work in (
        lambda: HistoryWriter(missing / "history.h5", FAMILIES, {}),
        lambda: write_restart(missing, {}, {}),
        lambda: replace_text(missing / "status.json", "{}"),
        lambda: Log(missing / "log.txt"),
    ):
        with pytest.raises(OutputError, match="missing.*: No such file or directory"):
            work()
    with pytest.raises(OutputError, match="file: Not a directory"):
        StateWriter(tmp_path / "file", (block,), {})


def test_import_does_not_load_hdf5() -> None:
    modules = "blocks channels files history layout log peaks restart shapes states status"
    modules += " paraview.script paraview.xdmf"
    names = ", ".join(f"crashsolve.output.{name}" for name in modules.split())
    code = (
        f"import {names}, sys; print([m for m in ('h5py', 'numba', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
