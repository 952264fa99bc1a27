"""Claim: one line states how far all runs are; a run that another process holds is waited for."""

import threading
import time
from pathlib import Path
from typing import Any, cast

import pytest

from crashsolve.output.lock import Lock, is_held
from crashsolve.sweep.folder import Mark, Run, RunStatus, record
from crashsolve.sweep.run_pool import RunPool, Worker

MARK = Mark("deck", "files", "version")


def run(number: int) -> Run:
    return Run(number, {"a": str(number)}, {"a": str(number)}, MARK)


def pool(folder: Path) -> RunPool:
    return RunPool(Path("deck.yaml"), folder, 2, lambda run: ())


def test_one_line_reports_all_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_pool = pool(tmp_path)
    run_pool.run_all([])
    run_pool.states = {
        1: RunStatus("finished"),
        2: RunStatus("finished"),
        3: RunStatus("failed", "why"),
    }
    nobody = cast(Any, None)
    workers = [Worker(run(4), nobody, progress=0.5), Worker(run(5), nobody, progress=0.25)]
    # 3.75 of 10 runs in 15 s
    run_pool._count, run_pool._ended, run_pool._started = 10, 3, time.monotonic() - 15.0
    reported = run_pool._progress(workers, 5)
    assert reported == "1 failed, 2 finished; running 0004 50 %, 0005 25 %; 5 waiting; 25 s left"


def test_a_lock_is_shared_or_alone(tmp_path: Path) -> None:
    assert not is_held(tmp_path)
    others = pytest.raises(Exception, match="another run writes")
    with Lock(tmp_path, is_shared=True), Lock(tmp_path, is_shared=True), others:
        Lock(tmp_path)
    with Lock(tmp_path):
        assert is_held(tmp_path)
        with pytest.raises(Exception, match="another run writes"):
            Lock(tmp_path, is_shared=True)
    assert not is_held(tmp_path)


def test_a_run_that_another_process_holds_is_waited_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = run(1).folder(tmp_path)
    folder.mkdir(parents=True)
    held = Lock(folder)

    def end() -> None:
        # what a run leaves that ends so
        record(tmp_path, run(1), "running")
        (folder / "status.json").write_text('{"state": "failed", "exit_code": 4, "message": "m"}')
        held.__exit__()

    timer = threading.Timer(0.5, end)
    timer.start()
    run_pool = pool(tmp_path)
    run_pool.run_all([run(1)])
    timer.join()
    assert run_pool.states[1] == RunStatus("failed", "m")
    assert capsys.readouterr().out.splitlines() == [
        "  0001 runs in another process: waiting for its end",
        "  0001 failed, exit code 4: m",
    ]
