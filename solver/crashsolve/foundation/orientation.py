"""Rotations during the build, in numpy: quaternions (w, x, y, z) and matrices, body to world."""

from collections.abc import Iterable, Sequence

import numpy as np


def matrix(q: Iterable[float]) -> np.ndarray:
    """Rotation matrix (3, 3) of a unit quaternion (4,), scalar first."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def matrices(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    w, x, y, z = q.T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def products(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Products (n, 4) of quaternions."""
    a, b, c, d = p.T
    w, x, y, z = q.T
    return np.array(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    ).T


def crosses(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Cross products of vectors (..., 3); the same digits as numpy's own, which is for any axis."""
    products = np.empty(np.broadcast_shapes(u.shape, v.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.subtract(u[..., j] * v[..., k], u[..., k] * v[..., j], out=products[..., i])
    return products


def rotated_by(q: np.ndarray, q_0: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3) [rad], at most pi long, from q_0 to q (n, 4), in world axes."""
    rotation = products(q, q_0 * [1.0, -1.0, -1.0, -1.0])
    rotation *= np.where(rotation[:, :1] < 0.0, -1.0, 1.0)
    sine = np.linalg.norm(rotation[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, rotation[:, 0])
    # of a small rotation the vector is twice its sine
    factor = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0.0)
    return factor[:, None] * rotation[:, 1:]


def perpendicular(axis: np.ndarray) -> np.ndarray:
    """A unit vector (3,) at right angles to one, from the world axis most across it."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    side = crosses(axis, helper)
    return side / np.linalg.norm(side)


def quaternion_of(A: np.ndarray) -> np.ndarray:
    """Unit quaternion (4,) of a rotation matrix (3, 3).

    Shepperd (1978), J. Guidance Control 1, 223-224: from its largest component.
    """
    trace = float(np.trace(A))
    k = int(np.argmax([trace, *np.diag(A)]))
    q = np.zeros(4)
    if k == 0:
        q[:] = 1.0 + trace, A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]
    else:
        x, y, z = (k - 1 + np.arange(3)) % 3
        q[0] = A[z, y] - A[y, z]
        q[1 + x] = 1.0 + 2.0 * A[x, x] - trace
        q[1 + y], q[1 + z] = A[y, x] + A[x, y], A[z, x] + A[x, z]
    return q / np.linalg.norm(q)


def relative(q_a: Sequence[float] | np.ndarray, q_b: Sequence[float] | np.ndarray) -> np.ndarray:
    """Unit quaternion (4,) q_a^-1 q_b: orientation of b in axes of a."""
    w_a, w_b, v_a, v_b = q_a[0], q_b[0], np.asarray(q_a[1:]), np.asarray(q_b[1:])
    return np.array([w_a * w_b + v_a @ v_b, *(w_a * v_b - w_b * v_a - np.cross(v_a, v_b))])
