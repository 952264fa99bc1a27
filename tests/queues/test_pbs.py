"""Claim: the script for PBS stops before its time ends, and submits itself until it is done."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command import environment

QUEUE = Path(__file__).resolve().parents[2] / "decks" / "queue"


@pytest.mark.long
def test_the_script_submits_itself_until_the_run_is_done(tmp_path: Path) -> None:
    shutil.copy(QUEUE / "pbs.sh", tmp_path)
    text = (QUEUE / "wagon.yaml").read_text("utf-8")
    control = "control: {estimate: 'off', step: 1.0e-8, "
    (tmp_path / "long.yaml").write_text(text.replace("control: {", control), "utf-8")
    # qsub that only notes what it is given
    tools, requested = tmp_path / "tools", tmp_path / "asked.txt"
    tools.mkdir()
    (tools / "qsub").write_text(f'#!/bin/sh\necho "$@" >> {requested}\n', "utf-8")
    (tools / "qsub").chmod(0o755)
    given = environment(
        PATH=f"{tools}:{environment()['PATH']}",
        PBS_O_WORKDIR=str(tmp_path),
        CRASHSOLVE=f"{sys.executable} -m crashsolve",
        **{"DECK": "long.yaml", "RESULTS": "out"},
    )
    for attempt in range(1, 30):
        # a busy machine may need as long for the start alone
        given["LIMIT"] = str(4 * attempt)
        done = subprocess.run(["bash", "pbs.sh"], cwd=tmp_path, env=given, capture_output=True)
        assert done.returncode == 0, done.stderr
        submitted = requested.read_text("utf-8").splitlines() if requested.exists() else []
        if len(submitted) < attempt:
            break
        assert submitted[-1].endswith("pbs.sh")
        assert f"LIMIT={4 * attempt},DECK=long.yaml,RESULTS=out,SWEEP=,RUN=" in submitted[-1]
    assert attempt > 1, "the run was done before its time was over"
    status = json.loads((tmp_path / "out" / "status.json").read_text("utf-8"))
    assert status["state"] == "finished"
