"""Claim: the impulse that a kerb gives a wheel does not depend on the step."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result

DECK = """# a wheel of 41 kg rolls at 5 m/s over a kerb of 30 mm, whose foot is 0.2 m ahead
title: Wheel over a kerb
control: {end_time: 0.12, start: equilibrium, step: STEP, estimate: "off"}
output: {history: {interval: 1.0e-3}}
bodies:
  slider: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.3], velocity: [5, 0, 0]}
  mast: {mass: 20, inertia: [1, 1, 1], position: [0, 0, 0.3], velocity: [5, 0, 0]}
  wheel: {mass: 20, inertia: [0.5, 0.9, 0.5], position: [0, 0, 0.3], velocity: [5, 0, 0]}
joints:
  rail: {type: prismatic, b: slider, at: [0, 0, 0.3], axis: [1, 0, 0]}
  up: {type: prismatic, a: slider, b: mast, at: [0, 0, 0.3], axis: [0, 0, 1]}
  hub: {type: revolute, a: mast, b: wheel, at: [0, 0, 0.3], axis: [0, 1, 0]}
surfaces:
  road: {type: plane}
  kerb: {type: box, size: [2, 2, 0.03], at: [1.2, 0, 0.015]}
tyres:
  t: {type: gim, wheel: wheel, road: [road, kerb], radius: 0.3, stiffness: 2.0e5, damping: 300,
    friction_max: 0.9, slip_stiffness: 8.0e4, cornering_stiffness: 6.0e4}
loads: {g: {type: gravity, acceleration: [0, 0, -9.81]}}
"""


def velocity_change(folder: Path, step: str) -> np.ndarray:
    """Of the wheel, along and up [m/s]."""
    deck, out = folder / f"{step}.yaml", folder / step
    deck.write_text(DECK.replace("STEP", step), "utf-8")
    done = crashsolve(deck, "-o", out)
    assert done.returncode == 0, done.stdout + done.stderr
    speeds = [Result(out).series(f"rbdout.wheel.velocity.{axis}").values for axis in "xz"]
    return np.array([v[-1] - v[0] for v in speeds])


def test_a_wheel_that_begins_in_a_kerb_is_reported(tmp_path: Path) -> None:
    """Its foot is 0.2 m ahead, and a kerb of 0.1 m reaches to within the radius of 0.3 m."""
    text = DECK.replace("start: equilibrium, step: STEP", "step: 1e-4").replace("0.12", "1e-3")
    deck, higher = tmp_path / "deck.yaml", text.replace("2, 0.03]", "2, 0.1]")
    deck.write_text(higher.replace("0.015]", "0.05]"), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert "tyre 't' is pressed by" in done.stdout + done.stderr
    deck.write_text(text, "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    assert "is pressed by" not in done.stdout + done.stderr


def test_a_wheel_that_passes_a_thin_wall_within_a_step_is_reported(tmp_path: Path) -> None:
    """At 60 m/s the wall of 0.2 mm is passed in a step of 6 mm; the tyre cannot stop 41 kg."""
    text = DECK.replace("start: equilibrium, step: STEP", "step: 1e-4").replace("0.12", "0.02")
    text = text.replace("[5, 0, 0]", "[60, 0, 0]").replace("[2, 2, 0.03]", "[2e-4, 2, 1]")
    deck = tmp_path / "deck.yaml"
    deck.write_text(text.replace("[1.2, 0, 0.015]", "[0.5, 0, 0.5]"), "utf-8")
    done = crashsolve(deck, "-o", tmp_path / "out")
    result = Result(tmp_path / "out")
    # it has come out behind
    assert result.series("rbdout.wheel.position.x").values[-1] > 0.6
    assert result.series("rbdout.wheel.velocity.x").values[-1] > 0.0
    assert "tyre 't': the wheel centre has reached the road" in done.stdout + done.stderr


@pytest.mark.long
def test_a_kerb_gives_the_same_impulse_at_three_steps(tmp_path: Path) -> None:
    changes = [velocity_change(tmp_path, step) for step in ("2e-4", "1e-4", "5e-5")]
    # the edge is met within a step: V h = 1 mm of the 131 mm of way on the kerb, times the change
    assert np.ptp(changes, axis=0).max() <= 1e-2 * np.abs(changes[-1]).min()
    # it slows the wheel and throws it up
    assert changes[-1][0] < -0.1 and changes[-1][1] > 0.1
