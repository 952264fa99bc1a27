"""Claim: linkages pass their flat configuration at any step, and keep to the solution."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, datasets

DECKS = Path(__file__).resolve().parents[2] / "decks"
DECK = DECKS / "benchmark" / "four_bar_singular.yaml"
END = 1.5  # two passes: 0.714 s and 1.234 s


def angle(end: float) -> float:
    """3 theta'' = -3.5 g cos(theta) from upright with theta' = -1, by Runge-Kutta."""

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -3.5 / 3.0 * 9.81 * np.cos(y[0])])

    y, n = np.array([np.pi / 2, -1.0]), 3000
    h = end / n
    for _ in range(n):
        a = rate(y)
        b = rate(y + 0.5 * h * a)
        c = rate(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(y + h * c))
    return float(y[0])


# the second and third step fall on other sides of the flat configuration than the first
@pytest.mark.parametrize("step", [1e-3, 2.3e-4, 7.1e-5])
def test_the_flat_configuration_is_passed(tmp_path: Path, step: float) -> None:
    settings = ("--set", f"step={step}", "--set", f"end={END}", "--set", "control.estimate=off")
    done = crashsolve(DECK, "-o", tmp_path, *settings)
    assert done.returncode == 0, done.stdout + done.stderr
    history = datasets(tmp_path / "history.h5")
    x = 2.0 * history["rbdout/position/x"][-1, 0]
    # what each pass leaves depends on where its steps fall, and goes with h^2: 70 to 108 h^2 here
    assert x == pytest.approx(np.cos(angle(END)), abs=200.0 * step**2)
    assert np.abs(history["rbdout/angular_velocity/z"][-1, 3:]).max() < 1e-6


# a step that crosses the flat configuration at a stage: the open joints of a stage are magnified
# without bound there, and the iteration needs rates of closed ones
@pytest.mark.parametrize("tolerance, start", [(5e-7, 1e-12), (1e-7, 0.0), (5e-8, 1e-9)])
def test_collocation_passes_the_flat_configuration(
    tmp_path: Path, tolerance: float, start: float
) -> None:
    settings = {"start": start, "control.tolerance": tolerance, "control.estimate": "off"}
    settings |= {"control.step": "auto", "control.integrator": "radau_iia_5", "end": 1.2}
    words = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
    done = crashsolve(DECKS / "extreme" / "singular.yaml", "-o", tmp_path, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    history = datasets(tmp_path / "history.h5")
    # crank_1 turns uniformly, and the coupler stays level; some hundred errors of a step add up
    x = 0.5 * np.cos(start + 3.0 * 1.2)
    assert history["rbdout/position/x"][-1, 0] == pytest.approx(x, abs=100.0 * tolerance)
    assert np.abs(history["rbdout/angular_velocity/z"][:, 2]).max() < 1e-3
