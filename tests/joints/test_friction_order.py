"""Claim: friction in joints follows a reaction that changes to second order in the step.

In each scene the bristle is at its limit from the start, as its damper alone exceeds it, and no
motion turns back: there are no corners.
"""

from math import cos, hypot, sin
from pathlib import Path

import numpy as np
import pytest
from small_runs import last, run, slopes

STEPS = (4e-3, 2e-3, 1e-3)
END = 0.2
G = 9.81
BRISTLE = {"stiffness": 1e4, "damping": 20}
# pendulum of 1 kg and 0.2 kg m^2 on an arm of 1 m that never turns back
INERTIA, PIN, ROTATION_ABOUT_AXIS = 0.2, 0.1, 12.0
# block of 1 kg pressed by 20 N (1 + sin(6 t) / 2)
PRESS, MU, SPEED = 20.0, 0.3, 5.0


def pendulum_and_slider() -> dict[str, object]:
    times = np.linspace(0.0, 1.0, 201)
    points = np.stack([times, 1.0 + 0.5 * np.sin(6.0 * times)], axis=1)
    friction_force = {
        "type": "rotation_friction",
        "joint": "pin",
        "friction_coefficient": 2.0 * PIN,
        "radius": 0.5,
    }
    return {
        "curves": {"press": {"points": points.tolist(), "interpolation": "cubic"}},
        "bodies": {
            "bob": {
                "mass": 1,
                "inertia": [INERTIA] * 3,
                "position": [0, -1, 0],
                "velocity": [ROTATION_ABOUT_AXIS, 0, 0],
                "angular_velocity": [0, 0, ROTATION_ABOUT_AXIS],
            },
            "block": {
                "mass": 1,
                "inertia": [1, 1, 1],
                "position": [0, 0, 5],
                "velocity": [SPEED, 0, 0],
            },
        },
        "joints": {
            "pin": {"type": "revolute", "b": "bob", "at": [0, 0, 0], "axis": [0, 0, 1]},
            "rail": {"type": "prismatic", "b": "block", "at": [0, 0, 5], "axis": [1, 0, 0]},
        },
        "springs": {
            "pin": friction_force | BRISTLE,
            "rail": {"type": "translation_friction", "joint": "rail", "friction_coefficient": MU}
            | BRISTLE,
        },
        "loads": {
            "weight": {"type": "force", "body": "bob", "force": [0, -G, 0]},
            "press": {"type": "force", "body": "block", "force": [0, -PRESS, 0], "curve": "press"},
        },
    }


def ladder(speed: float) -> dict[str, object]:
    """Two blocks on crossed rails with a link between, which leans at 69 degrees.

    Friction on the level rail changes the force in the link, which presses on that rail.
    """
    x, y = cos(1.2), sin(1.2)
    body = {"mass": 1, "inertia": [1, 1, 1]}
    return {
        "bodies": {
            "foot": body | {"position": [x, 0, 0], "velocity": [speed, 0, 0]},
            "head": body | {"position": [0, y, 0], "velocity": [0, -speed * x / y, 0]},
        },
        "joints": {
            "level": {"type": "prismatic", "b": "foot", "at": [x, 0, 0], "axis": [1, 0, 0]},
            "upright": {"type": "prismatic", "b": "head", "at": [0, y, 0], "axis": [0, 1, 0]},
            "link": {"type": "distance", "a": "foot", "b": "head"},
        },
        "springs": {
            "level": {"type": "translation_friction", "joint": "level", "friction_coefficient": 0.6}
            | {"stiffness": 1e5, "damping": 100}
        },
        "loads": {"weight": {"type": "gravity", "acceleration": [0, -G, 0]}},
    }


def exact_turn() -> float:
    """Angular velocity of the pendulum, by Runge and Kutta's fourth-order method."""

    def rate(y: np.ndarray) -> np.ndarray:
        angle, w = y
        w_dot = 0.0
        # the friction is in the reaction across the arm, and that in the friction
        for _ in range(40):
            reaction = hypot(w * w + G * cos(angle), w_dot + G * sin(angle))
            w_dot = (-G * sin(angle) - PIN * reaction) / (1.0 + INERTIA)
        return np.array([w, w_dot])

    y, h = np.array([0.0, ROTATION_ABOUT_AXIS]), END / 400
    for _ in range(400):
        a = rate(y)
        b = rate(y + 0.5 * h * a)
        c = rate(y + 0.5 * h * b)
        d = rate(y + h * c)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return float(y[1])


@pytest.mark.long
def test_pendulum_and_slider_converge_at_order_two(tmp_path: Path) -> None:
    runs = [run(tmp_path, pendulum_and_slider(), END, h) for h in STEPS]
    rotation, speed = exact_turn(), SPEED - MU * PRESS * (END + 0.5 * (1.0 - cos(6.0 * END)) / 6.0)
    errors = [
        [abs(last(result, channel) - exact) for result in runs]
        for channel, exact in (
            ("rbdout.bob.angular_velocity.z", rotation),
            ("rbdout.block.velocity.x", speed),
        )
    ]
    # with the reaction of the step before, both are of order one
    for error in errors:
        assert np.all(slopes(error) >= 1.8)


@pytest.mark.long
def test_friction_that_changes_its_own_reaction_converges_at_order_two(tmp_path: Path) -> None:
    for speed in (3.0, -3.0):
        runs = [run(tmp_path, ladder(speed), 0.04, h) for h in (1e-3, 5e-4, 2.5e-4)]
        speeds = [last(result, "rbdout.foot.velocity.x") for result in runs]
        # the halved step against the step: errors of both have the same sign
        assert np.all(slopes(np.abs(np.diff(speeds)).tolist()) >= 1.8)
