"""A damper with different constants for both directions: closed form, order, wrong curves."""

from math import cos, exp, log2, pi, sin, sqrt
from pathlib import Path

import pytest
from bench import Bench
from small_runs import last, run

from crashsolve.foundation.errors import DeckErrors

# kg, N/m, N s/m to lengthen and to shorten, m at the start, s
MASS, STIFFNESS, OUTWARD, INWARD, START, END = 2.0, 800.0, 8.0, 20.0, 0.1, 0.4
OIL = {"points": [[-5, -5 * INWARD], [0, 0], [5, 5 * OUTWARD]]}


def swing(t: float) -> float:
    """Elongation of a spring beside this damper, released at START [m]: half by half."""
    x, damping, other = START, INWARD, OUTWARD
    while True:
        decay = damping / (2.0 * MASS)
        omega = sqrt(STIFFNESS / MASS - decay**2)
        half = pi / omega
        if t <= half:
            return x * exp(-decay * t) * (cos(omega * t) + decay / omega * sin(omega * t))
        x, t = -x * exp(-decay * half), t - half
        damping, other = other, damping


def error(folder: Path, **control: object) -> float:
    scene = {
        "control": {"end_time": END, "estimate": "off", **control},
        "curves": {"oil": OIL},
        "bodies": {"mass": {"mass": MASS, "inertia": [1, 1, 1], "position": [1 + START, 0, 0]}},
        "springs": {
            "spring": {"type": "linear", "b": "mass", "stiffness": STIFFNESS, "length": 1.0},
            "damper": {"type": "damper", "b": "mass", "curve": "oil"},
        },
    }
    position = last(run(folder, scene, END, control.get("step")), "rbdout.mass.position.x")
    return abs(position - 1.0 - swing(END))


def test_the_error_falls_with_the_square_of_the_step(tmp_path: Path) -> None:
    coarse, fine = (error(tmp_path, step=END / n) for n in (1000, 8000))
    # where in a step a corner falls changes its own error, of h^2 as well, by a half or so
    assert log2(coarse / fine) / 3 == pytest.approx(2.0, abs=0.25)
    assert fine < 1e-7 * START


@pytest.mark.long
def test_a_method_of_high_order_meets_its_tolerance_over_the_corners(tmp_path: Path) -> None:
    # the tolerance is that of one step; some tens of steps add up
    words = {"integrator": "dormand_prince_5", "tolerance": 1e-9, "step": "auto"}
    assert error(tmp_path, **words) < 1e-7 * START


WRONG = {
    "must have the point (0, 0): no force at rest": "[[-1, -9], [1, 9]]",
    "adds energy at": "[[-2, -9], [-1, 1], [0, 0], [1, 9]]",
    "falls at an end": "[[-1, -9], [0, 0], [1, 9], [2, 3]], extrapolate: linear",
}


@pytest.mark.parametrize("message", list(WRONG))
def test_a_curve_that_is_no_damper_is_refused(message: str, tmp_path: Path) -> None:
    text = (
        f"curves: {{oil: {{points: {WRONG[message]}}}}}\n"
        "springs: {s: {type: damper, a: a, b: b, curve: oil}}\n"
    )
    with pytest.raises(DeckErrors, match=message.replace("(", r"\(").replace(")", r"\)")):
        Bench(tmp_path, text)
