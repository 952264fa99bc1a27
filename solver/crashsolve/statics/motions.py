"""Small motions of nodes at rest: displacements and rotations, and those between two states."""

import numpy as np

from crashsolve.foundation.orientation import matrices, matrix, products


def move(nodes: np.ndarray, change: np.ndarray) -> None:
    """Move nodes by displacements and rotations (n, 6). Writes: nodes."""
    nodes["r"] += change[:, :3]
    half = 0.5 * np.linalg.norm(change[:, 3:], axis=1)[:, None]
    q = products(np.hstack([np.cos(half), 0.5 * np.sinc(half / np.pi) * change[:, 3:]]), nodes["q"])
    nodes["q"] = q / np.linalg.norm(q, axis=1)[:, None]
    nodes["A"] = matrices(nodes["q"]).reshape(-1, 9)


def perturb(row: np.void, k: int, size: float) -> None:
    """Move a node along axis k [m], or turn it about axis k - 3 [rad], by very little.

    Writes: row.
    """
    if k < 3:
        row["r"][k] += size
        return
    rotation = np.array([1.0, 0.0, 0.0, 0.0])
    rotation[k - 2] = 0.5 * size
    row["q"] = products(rotation, row["q"])
    row["A"] = matrix(row["q"]).ravel()


def largest_motion(change: np.ndarray, size: float) -> float:
    """The largest of displacements [over a size, m] and rotations [rad] (n, 6)."""
    far, angle = np.abs(change[:, :3]).max(initial=0.0), np.abs(change[:, 3:]).max(initial=0.0)
    return float(max(far / size, angle))


def rotations(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3), world axes, from configurations q to configurations p (n, 4)."""
    rotation = products(p, q * [1.0, -1.0, -1.0, -1.0])
    rotation *= np.where(rotation[:, :1] < 0.0, -1.0, 1.0)
    sine = np.linalg.norm(rotation[:, 1:], axis=1)[:, None]
    over = 2.0 * np.arctan2(sine, rotation[:, :1]) / np.maximum(sine, 1e-12)
    return rotation[:, 1:] * np.where(sine > 1e-12, over, 2.0)
