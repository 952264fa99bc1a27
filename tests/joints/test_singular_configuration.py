"""Claim: two four-bar loops pass their flat configuration at any step, and keep to the solution."""

from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, datasets

DECK = Path(__file__).resolve().parents[2] / "decks" / "benchmark" / "four_bar_singular.yaml"
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
def test_the_flat_posture_is_passed(tmp_path: Path, step: float) -> None:
    settings = ("--set", f"step={step}", "--set", f"end={END}", "--set", "control.estimate=off")
    done = crashsolve(DECK, "-o", tmp_path, *settings)
    assert done.returncode == 0, done.stdout + done.stderr
    history = datasets(tmp_path / "history.h5")
    x = 2.0 * history["rbdout/position/x"][-1, 0]
    # what each pass leaves depends on where its steps fall, and goes with h^2: 70 to 108 h^2 here
    assert x == pytest.approx(np.cos(angle(END)), abs=200.0 * step**2)
    assert np.abs(history["rbdout/angular_velocity/z"][-1, 3:]).max() < 1e-6
