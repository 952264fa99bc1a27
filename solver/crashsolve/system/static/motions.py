"""Small motions of nodes at rest: displacements and turns, and the ways between two of them."""

from typing import Any

import numpy as np

from crashsolve.foundation.orientation import matrices, matrix, products


def move(nodes: np.ndarray, way: np.ndarray) -> None:
    """Move nodes by displacements and turns (n, 6). Writes: nodes."""
    nodes["r"] += way[:, :3]
    half = 0.5 * np.linalg.norm(way[:, 3:], axis=1)[:, None]
    q = products(np.hstack([np.cos(half), 0.5 * np.sinc(half / np.pi) * way[:, 3:]]), nodes["q"])
    nodes["q"] = q / np.linalg.norm(q, axis=1)[:, None]
    nodes["A"] = matrices(nodes["q"]).reshape(-1, 9)


def nudge(row: Any, k: int, size: float) -> None:
    """Move a node along axis k [m], or turn it about axis k - 3 [rad], by very little.

    Writes: row.
    """
    if k < 3:
        row["r"][k] += size
        return
    turn = np.array([1.0, 0.0, 0.0, 0.0])
    turn[k - 2] = 0.5 * size
    row["q"] = products(turn, row["q"])
    row["A"] = matrix(row["q"]).ravel()


def turns(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3), world axes, from configurations q to configurations p (n, 4)."""
    turn = products(p, q * [1.0, -1.0, -1.0, -1.0])
    turn *= np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    sine = np.linalg.norm(turn[:, 1:], axis=1)[:, None]
    over = 2.0 * np.arctan2(sine, turn[:, :1]) / np.maximum(sine, 1e-12)
    return turn[:, 1:] * np.where(sine > 1e-12, over, 2.0)
