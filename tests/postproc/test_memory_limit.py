"""Claim: a limit of memory is named as the cause, and bounds no small result."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest
from small_results import two_cars, write_result, write_status

from crashpost import cli
from crashpost.errors import memory_limit

# [bytes] of addresses: Python, numpy and h5py take 0.12 GB, and a picture some 0.5 GB
LIMIT = 250_000_000


def test_a_small_result_is_read_within_a_limit(tmp_path: Path) -> None:
    folder = tmp_path / "x.results"
    write_result(folder, two_cars())
    write_status(folder)
    done = subprocess.run(
        [sys.executable, "-m", "crashpost", "summary", str(folder)],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (LIMIT, LIMIT)),
    )
    assert done.returncode == 0, done.stderr


def test_the_limit_is_named_where_memory_runs_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_out(options: object) -> int:
        raise MemoryError

    monkeypatch.setattr("crashpost.errors.getrlimit", lambda which: (LIMIT, LIMIT))
    monkeypatch.setattr(cli, "_summary", run_out)
    assert memory_limit() == "memory is limited to 0.25 GB (ulimit -v)"
    assert cli.main(["summary", str(tmp_path)]) == cli.REFUSED
    assert "memory is limited to 0.25 GB" in capsys.readouterr().err
