"""Claim: what ranges and friction of a joint put on its body b is an output, in axes of b."""

from pathlib import Path

import numpy as np
import pytest
from small_runs import run

# a body that spins about three axes on a ball on the ground, within a narrow cone
SCENE = {
    "bodies": {
        "b": {
            "mass": 2.0,
            "inertia": [0.03, 0.04, 0.05],
            "angular_velocity": [3.0, -2.0, 4.0],
        }
    },
    "joints": {"ball": {"type": "spherical", "b": "b", "at": [0, 0, 0]}},
    "springs": {
        "cone": {
            "type": "cone_stop",
            "joint": "ball",
            "axis": [0, 0, 1],
            "toward": [1, 0, 0],
            "pointer": [0, 0, 1],
            "half_angles": ["5 deg", "9 deg", "7 deg", "5 deg"],
            "stiffness": 60.0,
            "transition": 0.05,
            "damping": 0.1,
        },
        "twist": {
            "type": "twist_stop",
            "joint": "ball",
            "axis": [0, 0, 1],
            "toward": [1, 0, 0],
            "pointer": [0, 0, 1],
            "toward_b": [1, 0, 0],
            "lower": "-5 deg",
            "upper": "5 deg",
            "stiffness": 60.0,
            "transition": 0.05,
        },
        "rest": {
            "type": "rotation_friction",
            "joint": "ball",
            "torque": 0.4,
            "stiffness": 50.0,
            "damping": 0.2,
        },
    },
    "output": {"history": {"interval": 2e-3}},
}


@pytest.mark.long
def test_moments_of_ranges_and_friction_turn_the_body(tmp_path: Path) -> None:
    """Euler: J w_dot + w x J w, in axes of b, is the sum of all three; the ball gives no moment."""
    result = run(tmp_path, SCENE, 0.1, 2e-5)

    def three(name: str) -> np.ndarray:
        return np.array([result.series(f"{name}.{axis}").values for axis in "xyz"])

    q = np.array([result.series(f"rbdout.b.quaternion.{part}").values for part in "wxyz"])
    J = np.array([0.03, 0.04, 0.05])[:, None]

    def to_body(u: np.ndarray) -> np.ndarray:
        w, v = q[0], -q[1:]
        return u + 2.0 * np.cross(v, np.cross(v, u, axis=0) + w * u, axis=0)

    w, w_dot = (
        to_body(three("rbdout.b.angular_velocity")),
        to_body(three("rbdout.b.angular_acceleration")),
    )
    needed = J * w_dot + np.cross(w, J * w, axis=0)
    parts = [three(f"deforc.{name}.moment") for name in ("cone", "twist", "rest")]
    assert all(np.abs(part).max() > 0.1 for part in parts)
    # samples are steps of no length: the equations hold to round-off of the accelerations
    assert sum(parts) == pytest.approx(needed, abs=1e-9 * np.abs(needed).max())
