"""Claim: a request stops a search for an equilibrium at once, and the run continues from the last
one to the same bits.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from command import crashsolve, differences, environment

# a bar on a hinge, drawn aside by a force that rises
DECK = """
title: a bar that hangs on a hinge is drawn aside
control: {end_time: 1, solution: quasi_static, steps: 4, estimate: off}
output: {restart: {every: 0.5}}
bodies: {bar: {mass: 2, inertia: [0.1, 0.1, 0.1], position: [0, 0, -0.5]}}
joints: {hinge: {type: revolute, b: bar, at: [0, 0, 0], axis: [0, 1, 0]}}
curves: {rise: {points: [[0, 0], [1, 1]]}}
loads:
  weight: {type: gravity}
  aside: {type: force, body: bar, force: [30, 0, 0], curve: rise}
"""
# the signal comes within a load step, of the first equilibrium or of a later one
SIGNAL = (
    "import os, signal, sys, crashsolve.statics.equilibrium as statics;"
    "kept = statics.StaticEngine.imbalance;"
    "statics.StaticEngine.imbalance = lambda engine, time: ("
    "time > MOMENT and os.kill(os.getpid(), signal.SIGTERM), kept(engine, time))[1];"
    "from crashsolve.cli import main; sys.exit(main(sys.argv[1:]))"
)


def stopped_at(moment: float, deck: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """A run that receives SIGTERM when forces are first asked for after a moment [s]."""
    words = [sys.executable, "-c", SIGNAL.replace("MOMENT", str(moment)), str(deck), "-o", str(out)]
    done = subprocess.run(words, capture_output=True, text=True, env=environment())
    assert done.returncode == 3, done.stdout + done.stderr
    return done


@pytest.mark.parametrize("path", ["", ", path: arc_length"])
def test_a_stop_within_a_load_step_continues_from_the_last_equilibrium(
    tmp_path: Path, path: str
) -> None:
    deck, whole, cut = tmp_path / "deck.yaml", tmp_path / "whole", tmp_path / "cut"
    deck.write_text(DECK.replace("steps: 4", "steps: 4" + path), "utf-8")
    assert crashsolve(deck, "-o", whole).returncode == 0
    log = stopped_at(0.6, deck, cut).stdout
    assert "stopped on request at t = " in log and "continue with --restart" in log
    assert crashsolve(deck, "-o", cut, "--restart").returncode == 0
    assert differences(whole, cut) == []


def test_a_stop_before_the_first_equilibrium_ends_the_run(tmp_path: Path) -> None:
    deck, out = tmp_path / "deck.yaml", tmp_path / "out"
    deck.write_text(DECK, "utf-8")
    stopped_at(-1.0, deck, out)
    status = json.loads((out / "status.json").read_text("utf-8"))
    assert status["message"] == "stopped on request before the run began"
