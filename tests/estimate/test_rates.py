"""Claim: an extreme of a position says what its velocities show between samples, and no more."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashpost.results.result import Result
from crashsolve.channels.series import Series
from crashsolve.estimate.rates import rise

PENDULUM = """
control: {end_time: 3.136, integrator: auto}
bodies:
  m: {mass: 22.28, inertia: [0.1434, 0.1434, 0.1434], position: [0.08492, 0, -0.1137],
      angular_velocity: [0, -4.435, 0], velocity: [0.5042595, 0, 0.3766202]}
joints: {h: {type: revolute, b: m, at: [0, 0, 0], axis: [0, 1, 0]}}
loads: {w: {type: gravity}}
springs: {s: {type: torsional, b: m, axis: [0, 1, 0], stiffness: 0, damping: 0.4285}}
output: {history: {interval: INTERVAL}}
watch:
  - {channel: rbdout.m.position.z, statistic: max}
  - {channel: rbdout.m.position.x, statistic: min}
  - {channel: deforc.s.angle, statistic: abs_max}
  - {channel: jntforc.h.force.z, statistic: max}
"""


def watched(folder: Path, interval: float) -> list[dict[str, float]]:
    """The watched numbers of a pendulum that swings once in 0.45 s."""
    folder.mkdir()
    deck = folder / "deck.yaml"
    deck.write_text(PENDULUM.replace("INTERVAL", str(interval)), "utf-8")
    done = crashsolve(deck, "-o", folder / "r")
    assert done.returncode == 0, done.stderr
    numbers: list[dict[str, float]] = Result(folder / "r").status["watched"]
    return numbers


@pytest.mark.parametrize("interval", [0.2337, 0.225, 0.2139])
def test_extremes_of_two_samples_a_period_are_right_within_their_errors(
    interval: float, tmp_path: Path
) -> None:
    fine = watched(tmp_path / "fine", 0.002)
    for true, number in zip(fine, watched(tmp_path / "coarse", interval), strict=True):
        assert abs(number["value"] - true["value"]) <= 10.0 * number["error"], number["channel"]
        # and of a history that is well sampled the errors stay small
        assert true["error"] <= 1e-4 * abs(true["value"]), true["channel"]


@pytest.mark.parametrize("word", ["max", "min", "abs_max"])
@pytest.mark.parametrize("samples", [1.0, 2.0])
def test_rates_show_a_vibration_that_is_sampled_at_its_zeros(word: str, samples: float) -> None:
    time = np.arange(0.0, 5.0, 1.0 / samples)
    x, v = np.sin(2.0 * np.pi * time), 2.0 * np.pi * np.cos(2.0 * np.pi * time)
    assert rise(Series(time, x), v, word) >= 0.33


@pytest.mark.parametrize("word", ["max", "min", "abs_max"])
@pytest.mark.parametrize("samples", [12, 20, 50])
def test_rates_add_nothing_to_what_samples_resolve(word: str, samples: int) -> None:
    for phase in np.linspace(0.0, 2.0 * np.pi, 24):
        time = np.arange(0.0, 5.0, 1.0 / samples)
        decay, angle = np.exp(-0.1 * time), 2.0 * np.pi * time + phase
        x, v = decay * np.cos(angle), -decay * (0.1 * np.cos(angle) + 2 * np.pi * np.sin(angle))
        # the error of parabolas is of the fourth power of the interval, that of samples the second
        assert rise(Series(time, x), v, word) <= (2.0 * np.pi / samples) ** 4 / 20.0, phase
