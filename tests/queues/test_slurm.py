"""Claim: in a real Slurm an array runs, a time limit is outlived, and a cancelled job is no loss.

Needs root, Debian's packages slurm-wlm and munge, and some minutes: `make queue`.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from command import crashsolve, differences, environment

ROOT = Path(__file__).resolve().parents[2]
NODE = Path(__file__).parent / "one_node_slurm.sh"
WAGON = ROOT / "decks" / "queue" / "wagon.yaml"
CRASHSOLVE = f"{sys.executable} -m crashsolve"
# [s] of CPU that a run takes: its job is reported to stop after half of it, or sooner where others
# run
LASTS = 60.0

pytestmark = [pytest.mark.queue, pytest.mark.xdist_group("slurm")]


@pytest.fixture(scope="module")
def slurm() -> Iterator[Path]:
    """A folder that jobs can reach, of a Slurm that goes with the tests."""
    if os.geteuid() != 0:
        pytest.skip("only root can set up a Slurm")
    folder = Path(tempfile.mkdtemp(prefix="one-node-"))
    folder.chmod(0o755)
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    subprocess.run([NODE, "start", folder], check=True, timeout=600)
    try:
        yield folder
    finally:
        subprocess.run([NODE, "stop", folder], check=True)
        shutil.rmtree(folder, ignore_errors=True)


def requested(*words: object, cwd: Path | None = None) -> str:
    """What a command of Slurm answers."""
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=environment(CRASHSOLVE=CRASHSOLVE),
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def shown(job: str) -> dict[str, str]:
    """What Slurm knows of a job."""
    words = requested("scontrol", "show", "job", job).split()
    return dict(word.split("=", 1) for word in words if "=" in word)


def wait_for_end(job: str, seconds: float = 1500.0) -> None:
    until = time.monotonic() + seconds
    while requested("squeue", "--noheader", "--job", job).strip():
        assert time.monotonic() < until, requested("squeue")
        time.sleep(1.0)


def long_step(folder: Path) -> str:
    """The step with which the steps of the wagon take LASTS seconds of CPU."""
    words = (WAGON, "-o", folder / "pace", "--set", "control.step=2e-7")
    words += ("--set", "control.estimate=off")
    # the first compiles
    assert crashsolve(*words).returncode == 0
    assert crashsolve(*words).returncode == 0
    status = json.loads((folder / "pace" / "status.json").read_text("utf-8"))
    return f"{2e-7 * status['cpu_steps'] / LASTS:.3g}"


def deck_of(folder: Path, step: str) -> Path:
    """A deck of its own with a step, and without estimates, which would run it again."""
    text = WAGON.read_text("utf-8")
    control = f"control: {{estimate: 'off', step: {step}, "
    path = folder / "long.yaml"
    path.write_text(text.replace("control: {", control), "utf-8")
    return path


def test_an_array_of_eight_runs_a_sweep(slurm: Path) -> None:
    plan, out = slurm / "eight.yaml", slurm / "eight"
    shutil.copy(WAGON, slurm / "wagon.yaml")
    plan.write_text(
        "deck: wagon.yaml\ndesign: {type: sobol, runs: 8}\n"
        'vary: {speed: {from: "5 km/h", to: "15 km/h"}}\n'
        "measure: [{name: peak, channel: rcforc.buffer.normal, statistic: max, unit: kN}]\n"
    )
    done = crashsolve("sweep", plan, "-o", out, "--submit", "--at-once", "3", "--time", "10")
    assert done.returncode == 0, done.stderr
    job = done.stdout.split("Submitted batch job ")[1].split()[0]
    most, begun = 0, time.monotonic()
    while lines := requested(
        "squeue", "--noheader", "--array", "--job", job, "--format=%t"
    ).split():
        most = max(most, lines.count("R"))
        time.sleep(0.2)
    assert 1 <= most <= 3
    print(f"\nan array of eight, {most} at once: {time.monotonic() - begun:.0f} s")
    # no runs are left, and the table is there
    again = crashsolve("sweep", plan, "-o", out)
    assert again.returncode == 0, again.stdout
    assert "8 runs in" in again.stdout and "8 finished already" in again.stdout
    rows = (out / "sweep.csv").read_text("utf-8").splitlines()
    assert len(rows) == 9 and all(row.endswith(",finished,") for row in rows[1:])


def test_a_time_limit_is_outlived_by_going_back_to_the_queue(slurm: Path) -> None:
    deck = deck_of(slurm, long_step(slurm))
    out, whole = slurm / "limit", slurm / "whole"
    script = ROOT / "decks" / "queue" / "slurm.sh"
    words = ("--parsable", "--time=1", "--signal=B:USR1@30", "--mem=0")
    job = requested("sbatch", *words, script, deck, out, cwd=slurm).strip()
    wait_for_end(job)
    end = shown(job)
    assert (end["JobState"], end["ExitCode"]) == ("COMPLETED", "0:0")
    assert int(end["Restarts"]) >= 1
    log = (out / "log.txt").read_text("utf-8")
    # Slurm may report a job that its time is up before there is a dump to go on from
    assert 1 <= log.count("continuing from t = ") <= int(end["Restarts"])
    assert log.endswith("N o r m a l    t e r m i n a t i o n\n")
    assert crashsolve(deck, "-o", whole).returncode == 0
    # the dumps of both are at the same times; a stop adds one
    assert [name for name in differences(out, whole) if not name.startswith("dump:")] == []
    print(f"\na time limit of one minute: {end['Restarts']} times requeued")


def test_a_cancelled_job_leaves_a_dump_and_does_not_come_back(slurm: Path) -> None:
    deck, out = deck_of(slurm, long_step(slurm)), slurm / "cancelled"
    script = ROOT / "decks" / "queue" / "slurm.sh"
    job = requested("sbatch", "--parsable", "--time=30", "--mem=0", script, deck, out, cwd=slurm)
    job = job.strip()
    until = time.monotonic() + 120.0
    while not (out / "restart_0.h5").exists():
        assert time.monotonic() < until, requested("squeue")
        time.sleep(0.5)
    requested("scancel", job)
    wait_for_end(job, 60.0)
    assert shown(job)["JobState"] == "CANCELLED"
    status = json.loads((out / "status.json").read_text("utf-8"))
    assert (status["state"], status["exit_code"]) == ("stopped", 3)
    assert 0.0 < status["time"] < status["end_time"]
    assert "continue with --restart" in status["message"]


def test_a_sweep_outlives_time_limits_task_by_task(slurm: Path) -> None:
    plan, out = slurm / "slow.yaml", slurm / "slow"
    deck_of(slurm, long_step(slurm))
    plan.write_text(
        'deck: long.yaml\ndesign: list\nvary: {speed: ["8 km/h", "12 km/h"]}\n'
        "measure: [{name: peak, channel: rcforc.buffer.normal, statistic: max, unit: kN}]\n"
    )
    words = ("--submit", "--time", "2", "--at-once", "2")
    done = crashsolve("sweep", plan, "-o", out, *words)
    assert done.returncode == 0, done.stderr
    wait_for_end(done.stdout.split("Submitted batch job ")[1].split()[0])
    reported = [path.read_text("utf-8") for path in sorted((out / "queue").glob("*.txt"))]
    assert all("stopped, exit code 3" in text and "finished" in text for text in reported)
    again = crashsolve("sweep", plan, "-o", out)
    assert (again.returncode, "2 finished already" in again.stdout) == (0, True)
