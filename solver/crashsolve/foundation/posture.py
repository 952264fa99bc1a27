"""Rotations during the build, in numpy: quaternions (w, x, y, z) and matrices, body to world."""

from typing import Any

import numpy as np


def matrix(q: Any) -> np.ndarray:
    """Rotation matrix of a unit quaternion."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def perpendicular(axis: np.ndarray) -> np.ndarray:
    """A unit vector at right angles to a unit vector, from the world axis most across it."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    side = np.cross(axis, helper)
    return side / np.linalg.norm(side)


def relative(q_a: Any, q_b: Any) -> np.ndarray:
    """Unit quaternion q_a^-1 q_b: posture of b in axes of a."""
    w_a, w_b, v_a, v_b = q_a[0], q_b[0], np.asarray(q_a[1:]), np.asarray(q_b[1:])
    return np.array([w_a * w_b + v_a @ v_b, *(w_a * v_b - w_b * v_a - np.cross(v_a, v_b))])
