"""Claim: supports bear every force in the motions that they hold, whatever the method."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result

SHEET = """
title: a sheet that its supports hold bears its weight
control: {CONTROL}
output: {history: {interval: 0.05}}
materials: {steel: {type: elastic, young: 2e9, poisson: 0.3, density: 7800}}
parts:
  sheet:
    type: shell
    mesh: {type: grid, along: [1, 0, 0], across: [0, 1, 0], elements: [1, 1]}
    thickness: 0.01
    material: steel
    traces: [{name: corner, at: [1, 1, 0]}]
    supports: [{nodes: u0, motions: HELD}, {nodes: u1, motions: HELD}]
loads: {weight: {type: gravity, acceleration: [3, 0, -9.81]}}
"""
METHODS = {
    "explicit": "end_time: 0.1, step: 1e-3",
    "generalized_alpha": "end_time: 0.1, step: 0.05, integrator: generalized_alpha",
    "radau_iia_5": "end_time: 0.1, step: 0.05, integrator: radau_iia_5",
    "quasi_static": "end_time: 0.1, solution: quasi_static, steps: 1",
}


def run(folder: Path, control: str, held: str) -> Result:
    deck = folder / "deck.yaml"
    deck.write_text(SHEET.replace("CONTROL", control).replace("HELD", held), "utf-8")
    done = crashsolve(deck, "-o", folder / "out", CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stdout + done.stderr
    return Result(folder / "out")


def last(result: Result, channel: str) -> float:
    return float(result.series(channel).values[-1])


@pytest.mark.parametrize("method", METHODS)
def test_a_held_sheet_rests_under_its_weight(tmp_path: Path, method: str) -> None:
    # rotations are free, so that each node has a body in implicit steps
    result = run(tmp_path, METHODS[method], "[x, y, z]")
    for axis in "xyz":
        assert last(result, f"nodout.sheet_corner.displacement.{axis}") == 0.0
    # the supports take the whole weight, to round-off of sums
    assert abs(last(result, "glstat.model.momentum_error")) < 1e-12


@pytest.mark.parametrize("method", [name for name in METHODS if name != "quasi_static"])
def test_what_supports_leave_free_falls(tmp_path: Path, method: str) -> None:
    result = run(tmp_path, METHODS[method], "[y, z]")
    # every node is accelerated alike, and methods of order two have no error in a parabola
    assert last(result, "nodout.sheet_corner.displacement.x") == pytest.approx(0.015, rel=1e-9)
    assert last(result, "nodout.sheet_corner.displacement.z") == 0.0
    assert abs(last(result, "glstat.model.momentum_error")) < 1e-12


@pytest.mark.long
def test_what_nothing_holds_is_named(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    text = SHEET.replace("CONTROL", METHODS["quasi_static"]).replace("HELD", "[x, y]")
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert done.returncode == 4, done.stdout + done.stderr
    for words in ("t = 0 s", "part 'sheet'", "however far it moves", "support what can move"):
        assert words in done.stderr
