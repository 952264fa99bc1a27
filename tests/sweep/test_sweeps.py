"""Claim: a sweep keeps what has finished, and its table holds nothing else."""

import json
import os
import random
import signal
import subprocess
import time
from pathlib import Path

import pandas
import pytest
from command import arguments, crashsolve, environment, start
from sweep.sweeping import (
    LONG,
    begun,
    gathered,
    status,
    swept,
    table,
    words_of,
    written,
)

from crashsolve.deck.reading.deck import read_deck
from crashsolve.sweep.folder import mark_of, text_mark

STEP = Path(__file__).parents[1] / "runs" / "stops" / "long_step.yaml"
# one worker runs all of them, and compiles their scene once
pytestmark = pytest.mark.xdist_group("sweeps")


def wait_for(folder: Path, number: int, cycles: int = 1) -> None:
    """Wait until a run has made some steps."""
    until = time.monotonic() + 600.0
    while (status(folder, number).get("cycle") or 0) < cycles:
        assert time.monotonic() < until, "the run never began"
        time.sleep(0.02)


def test_a_sweep_is_a_table_and_finished_runs_are_kept(tmp_path: Path) -> None:
    plan, out = written(tmp_path, 2), tmp_path / "out"
    done = swept(plan)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = table(out)
    assert [row["speed [km/h]"] for row in rows] == ["5.0", "6.0"]
    for row in rows:
        # v sqrt(k m); samples 1 ms apart of a half sine of 440 ms miss its peak by 1e-5 at most
        peak = float(row["speed [km/h]"]) / 3.6 * (1e6 * 20e3) ** 0.5 / 1e3
        assert float(row["peak [kN]"]) == pytest.approx(peak, rel=2e-5)
    frame = pandas.read_parquet(out / "sweep.parquet")
    assert frame["peak [kN]"].tolist() == [float(row["peak [kN]"]) for row in rows]
    assert frame["state"].tolist() == ["finished"] * 2

    # nothing is run again, and more runs are only added
    before, text = begun(out), (out / "sweep.csv").read_text("utf-8")
    again = swept(plan)
    assert (again.returncode, "2 finished already" in again.stdout) == (0, True)
    assert begun(out) == before
    assert (out / "sweep.csv").read_text("utf-8") == text
    assert swept(written(tmp_path, 3)).returncode == 0
    assert {name: begun(out)[name] for name in before} == before
    assert (out / "sweep.csv").read_text("utf-8").startswith(text)

    # what a run by hand leaves in the folder of a run is not that run
    folder = out / "runs" / "0002"
    assert crashsolve(tmp_path / "wagon.yaml", "-o", folder).returncode == 0
    assert "1 stale" in gathered(out).stdout
    row = table(out)[1]
    assert (row["state"], row["peak [kN]"]) == ("stale", "")

    # nor do results of another deck count, or get lost unasked
    deck = tmp_path / "wagon.yaml"
    deck.write_text(deck.read_text("utf-8").replace('"1 MN/m"', '"4 MN/m"'), "utf-8")
    refused = swept(plan)
    assert refused.returncode == 2
    assert "3 of 3 runs are there already, of another deck or other values" in refused.stderr
    assert begun(out)["0001"] == before["0001"]
    assert swept(plan, "--again", "stale").returncode == 0
    for row, old in zip(table(out), rows, strict=False):
        # a spring four times as stiff
        assert float(row["peak [kN]"]) == pytest.approx(2.0 * float(old["peak [kN]"]), rel=1e-4)


@pytest.mark.long
def test_a_run_that_fails_has_a_message_and_no_number(tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_text(STEP.read_text("utf-8"), "utf-8")
    plan, out = tmp_path / "plan.yaml", tmp_path / "out"
    plan.write_text(
        "deck: deck.yaml\ndesign: list\nset: {control.end_time: 0.2}\n"
        "vary: {control.step: [1.0e-4, 0.01]}\n"
        "measure: [{name: x, channel: rbdout.block.position.x, statistic: abs_max}]\n",
        "utf-8",
    )
    words = ("sweep", plan, "-o", out)
    done = crashsolve(*words, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 4
    assert "0002 failed, exit code 4: t = 0.1 s, cycle 10" in done.stdout
    good, bad = table(out)
    assert float(good["x [m]"]) > 0.0
    assert (bad["x [m]"], bad["state"]) == ("", "failed")
    assert "the energy balance is off by 104 %" in bad["message"]
    # reported again, not run again; on demand it is
    before = begun(out)
    again = crashsolve(*words, CRASHSOLVE_PLAIN="1")
    assert (again.returncode, begun(out)) == (4, before)
    assert "0002 failed before: t = 0.1 s" in again.stdout
    again = crashsolve(*words, "--again", "failed", CRASHSOLVE_PLAIN="1")
    assert again.returncode == 4
    assert begun(out)["0001"] == before["0001"]
    assert begun(out)["0002"] != before["0002"]


def test_a_measure_that_no_run_has_is_reported_and_corrected_at_no_cost(tmp_path: Path) -> None:
    plan, out = written(tmp_path, 2), tmp_path / "out"
    text = plan.read_text("utf-8")
    plan.write_text(text.replace("buffer.normal, statistic: max", "bufer.normal, statistic: max"))
    done = swept(plan)
    assert done.returncode == 2
    assert done.stdout.count("peak: 'rcforc.bufer.normal': unknown") == 2
    assert "measures may be corrected in the plan" in done.stdout
    before = begun(out)
    plan.write_text(text, "utf-8")
    assert swept(plan).returncode == 0
    assert begun(out) == before
    assert all(float(row["peak [kN]"]) > 0.0 for row in table(out))


def test_the_mark_of_a_run_covers_the_files_that_its_deck_reads(tmp_path: Path) -> None:
    (tmp_path / "curve.csv").write_text("0, 0\n1, 1\n", "utf-8")
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        "control: {end_time: 1}\nbodies: {b: {mass: 1, inertia: [1, 1, 1]}}\n"
        "curves: {c: {type: file, file: curve.csv}}\n"
        "loads: {f: {type: force, body: b, force: [1, 0, 0], curve: c}}\n",
        "utf-8",
    )
    first = mark_of(read_deck(deck))
    assert mark_of(read_deck(deck)) == first
    (tmp_path / "curve.csv").write_text("0, 0\n1, 2\n", "utf-8")
    other = mark_of(read_deck(deck))
    assert (other.deck, other.version) == (first.deck, first.version)
    assert other.files != first.files
    reported = {"deck": first.deck, "files": first.files, "version": "0.0.9-abc"}
    assert other.difference_from(reported) == (
        "other files that the deck reads, another version of crashsolve"
    )


def test_the_mark_distinguishes_methods_but_for_the_one_that_auto_chooses(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text("control: {end_time: 1}\nbodies: {b: {mass: 1, inertia: [1, 1, 1]}}\n")
    words = ("rattle", "radau_iia_5", "auto")
    marks = {w: mark_of(read_deck(deck, {"control.integrator": w})).deck for w in words}
    assert len(set(marks.values())) == 3
    text = read_deck(deck, {"control.integrator": "radau_iia_5"}).text
    assert text_mark(text, False) == marks["radau_iia_5"]
    # what a run writes that has chosen it
    assert text_mark(text, True) == marks["auto"]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The table of three long runs that nobody disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    assert swept(written(folder, 3, LONG)).returncode == 0
    return (folder / "out" / "sweep.csv").read_text("utf-8")


@pytest.mark.long
def test_a_sweep_that_is_stopped_goes_on_to_the_same_table(tmp_path: Path, whole: str) -> None:
    plan, out = written(tmp_path, 3, LONG), tmp_path / "out"
    sweep = start(*words_of(plan))
    wait_for(out, 1)
    # two sweeps in one folder
    other = swept(plan)
    assert (other.returncode, "another run writes to this folder" in other.stderr) == (5, True)
    sweep.send_signal(signal.SIGTERM)
    reported, _ = sweep.communicate(timeout=120)
    assert sweep.returncode == 3
    assert "each with a dump" in reported
    rows = table(out)
    assert {row["state"] for row in rows} <= {"finished", "stopped", "new"}
    assert "stopped" in {row["state"] for row in rows}
    # what a stopped run has so far is no answer
    assert all(bool(row["peak [kN]"]) == (row["state"] == "finished") for row in rows)
    done = swept(plan)
    assert done.returncode == 0, done.stdout
    assert "continue from where they were stopped" in done.stdout
    assert (out / "sweep.csv").read_text("utf-8") == whole


@pytest.mark.long
def test_a_sweep_killed_at_any_moment_goes_on_to_the_same_table(tmp_path: Path, whole: str) -> None:
    plan, out, dice = written(tmp_path, 3, LONG), tmp_path / "out", random.Random(7)
    for attempt in range(8):
        sweep = subprocess.Popen(
            arguments(*words_of(plan)),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env=environment(),
        )
        with pytest.raises(subprocess.TimeoutExpired):
            sweep.wait(dice.uniform(0.2, 5.0))
            pytest.skip("this machine is too fast for the test")
        # all of it, or only the process that conducts
        alone = attempt % 2 == 0
        os.kill(sweep.pid, signal.SIGKILL) if alone else os.killpg(sweep.pid, signal.SIGKILL)
        sweep.wait(60)
        if (out / "sweep.json").exists():
            assert gathered(out).returncode == 0
            for row in table(out):
                assert bool(row["peak [kN]"]) == (row["state"] == "finished")
    done = swept(plan)
    assert done.returncode == 0, done.stdout
    assert (out / "sweep.csv").read_text("utf-8") == whole


@pytest.mark.long
def test_a_worker_that_crashes_is_reported_and_goes_on(tmp_path: Path, whole: str) -> None:
    plan, out = written(tmp_path, 3, LONG), tmp_path / "out"
    sweep = start(*words_of(plan))
    wait_for(out, 1)
    os.kill(status(out, 1)["pid"], signal.SIGKILL)
    reported, _ = sweep.communicate(timeout=300)
    assert sweep.returncode == 1
    assert "0001 killed, exit code -9: killed by signal 9" in reported
    row = table(out)[0]
    assert (row["state"], row["message"], row["peak [kN]"]) == (
        *("killed", "killed by signal 9"),
        "",
    )
    assert swept(plan).returncode == 0
    assert (out / "sweep.csv").read_text("utf-8") == whole


@pytest.mark.long
def test_a_run_out_of_time_stops_and_goes_on(tmp_path: Path, whole: str) -> None:
    plan, out = written(tmp_path, 3, LONG), tmp_path / "out"
    text, limit = plan.read_text("utf-8"), 2.5
    plan.write_text(f"{text}time_limit: {limit}\n", "utf-8")
    done = swept(plan)
    assert done.returncode == 3, done.stdout
    assert "stopped, exit code 3: out of time: stopped on request " in done.stdout
    for _ in range(20):
        # a busy machine may need as long for the start alone
        limit *= 1.5
        plan.write_text(f"{text}time_limit: {limit}\n", "utf-8")
        done = swept(plan)
        if done.returncode == 0:
            break
        assert done.returncode == 3
    assert (out / "sweep.csv").read_text("utf-8") == whole


@pytest.mark.long
def test_tasks_of_an_array_run_what_was_prepared_and_nothing_else(tmp_path: Path) -> None:
    plan, out, tools = written(tmp_path, 4), tmp_path / "out", tmp_path / "tools"
    assert swept(plan, "--list").stdout.count("\n") == 4
    assert not out.exists()
    tools.mkdir()
    (tools / "sbatch").write_text("#!/bin/sh\necho Submitted $1\n", "utf-8")
    (tools / "sbatch").chmod(0o755)
    path = f"{tools}:{os.environ['PATH']}"
    words = (*words_of(plan), "--submit", "--at-once", "2", "--time", "5", "--sbatch=--mem=1G")
    done = crashsolve(*words, PATH=path)
    assert done.returncode == 0, done.stderr
    assert "Submitted " in done.stdout
    script = (out / "sweep.sbatch").read_text("utf-8")
    for line in ("--array=1-4%2", "--time=5", "--signal=B:USR1@60", "--requeue", "--mem=1G"):
        assert f"#SBATCH {line}\n" in script
    assert subprocess.run(["bash", "-n", str(out / "sweep.sbatch")]).returncode == 0
    # a task by itself, twice: the second finds it done
    assert crashsolve("sweep", out, "--run", 2).returncode == 0
    before = begun(out)
    again = crashsolve("sweep", out, "--run", 2)
    assert (again.returncode, "0002 finished already" in again.stdout) == (0, True)
    assert begun(out) == before
    assert crashsolve("sweep", out, "--run", 5).returncode == 2
    gathered(out)
    assert [row["state"] for row in table(out)] == ["new", "finished", "new", "new"]
    # what is left is what the next script has
    assert crashsolve(*words, PATH=path).returncode == 0
    assert "#SBATCH --array=1,3-4%2\n" in (out / "sweep.sbatch").read_text("utf-8")
    deck = tmp_path / "wagon.yaml"
    deck.write_text(deck.read_text("utf-8").replace('"1 MN/m"', '"2 MN/m"'), "utf-8")
    refused = crashsolve("sweep", out, "--run", 3)
    assert refused.returncode == 2
    assert "run 0003 was of another deck or other values; prepare the sweep anew" in refused.stderr
    assert json.loads((out / "sweep.json").read_text("utf-8"))["runs"][2]["number"] == 3
