"""Claim: runs killed two hundred times leave nothing unreadable, and go on to the same bits.

The moments are drawn over the whole life of a process: while it loads, steps, writes and ends.
"""

import json
import random
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree
from pathlib import Path

import h5py
import pytest
from command import crashsolve, differences, start

from crashpost.cli import main as crashpost
from crashpost.results.result import Result
from crashsolve.output.restart import newest_restart

ROOT = Path(__file__).resolve().parents[2]
DECKS = ROOT / "decks"
# decks, what is set in them, and how many kills each gets; states at intervals, since a continued
# run writes states of those events alone that follow its dump
CASES: dict[str, tuple[Path, dict[str, str], int]] = {
    "joints, springs and bristles": (ROOT / "tests/runs/mechanism.yaml", {}, 60),
    "unilateral contact": (
        DECKS / "benchmark/capture_loss.yaml",
        {"output.restart.every": "1e-5 s", "output.states.interval": "1e-5 s"},
        60,
    ),
    "failing shells": (
        DECKS / "verification/contact/faces_failing.yaml",
        {"output.restart.every": "1e-4 s", "output.states.interval": "1e-4 s"},
        40,
    ),
    "implicit steps of shells": (
        DECKS / "verification/parts/shell_ball_implicit.yaml",
        {
            "output.restart.every": "2e-5 s",
            "output.states.interval": "2e-5 s",
            "control.end_time": "2e-4 s",
        },
        40,
    ),
}


def is_readable(folder: Path) -> None:
    """Every file of a run is whole, whatever came upon the run; its dumps as well."""
    for path in folder.rglob("*.h5"):
        with h5py.File(path) as file:
            file.visititems(lambda _, item: item[()] if isinstance(item, h5py.Dataset) else None)
    if (folder / "status.json").exists():
        json.loads((folder / "status.json").read_text("utf-8"))
    if (folder / "states.xdmf").exists():
        xml.etree.ElementTree.parse(folder / "states.xdmf")
    if (folder / "history.h5").exists():
        assert crashpost(["summary", str(folder)]) == 0
        time_of = Result(folder).time
        assert (time_of[1:] > time_of[:-1]).all()
    said: list[str] = []
    newest_restart(folder, said.append)
    assert said == []


def steps_of(folder: Path) -> int:
    """Steps that a run has reported."""
    status = folder / "status.json"
    return int(json.loads(status.read_text("utf-8"))["cycle"]) if status.exists() else 0


def killed_after(seconds: float, words: tuple[object, ...]) -> bool:
    """Start a run and kill it; False for one that came to its end before."""
    run = start(*words, "--restart")
    try:
        run.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        run.kill()
        run.communicate()
    assert run.returncode in (0, -signal.SIGKILL)
    return run.returncode != 0


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_a_run_killed_repeatedly_continues_to_the_same_bits(name: str, tmp_path: Path) -> None:
    deck, overrides, kills = CASES[name]
    sets = {"control.estimate": "off"} | overrides
    more = [word for path, value in sets.items() for word in ("--set", f"{path}={value}")]
    whole, folder = tmp_path / "whole", tmp_path / "killed"
    # compiles; the second states how long a run lasts
    assert crashsolve(deck, "-o", whole, *more).returncode == 0
    begun = time.monotonic()
    assert crashsolve(deck, "-o", whole, *more).returncode == 0
    life = time.monotonic() - begun
    words, dice = (deck, "-o", folder, *more), random.Random(name)
    done, ended, resumed = 0, 0, 0
    while done < kills:
        was_killed = killed_after(dice.uniform(0.0, life), words)
        done += was_killed
        if folder.exists():
            is_readable(folder)
        log = folder / "log.txt"
        if was_killed:
            # a machine that others keep busy takes longer
            life *= 1.05 if steps_of(folder) == 0 else 1.0
            continue
        assert differences(folder, whole) == []
        resumed += log.read_text("utf-8").count("continuing from t = ")
        ended += 1
        shutil.rmtree(folder)
        life *= 0.9
    assert crashsolve(*words, "--restart").returncode == 0
    resumed += (folder / "log.txt").read_text("utf-8").count("continuing from t = ")
    assert differences(folder, whole) == []
    print(f"\n{name}: {done} kills, {resumed} times gone on, {ended + 1} runs to the same bits")
    assert resumed > 0
