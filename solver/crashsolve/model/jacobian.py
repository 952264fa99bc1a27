"""The Jacobian of the joints as one dense matrix, for computations outside the step."""

from collections.abc import Sequence

import numpy as np

from crashsolve.model.model import Joint


def whole_rows(joints: Sequence[Joint]) -> np.ndarray:
    """Rows of the table that represent constraints: the first parts of the joints'."""
    return np.array([j.first_row + k for j in joints for k in range(j.rows)], dtype=int)


def jacobian(joints: Sequence[Joint], rows: np.ndarray, count: int) -> np.ndarray:
    """D (m, count, 6) of all joints between `count` nodes, the ground among them.

    `rows` is the table of all parts; those of a row of more than two bodies add up.
    """
    D = np.zeros((len(rows), count, 6))
    index, first = np.arange(len(rows)), np.arange(len(rows))
    for j in joints:
        first[j.first_row : j.first_row + j.rows * j.parts] = np.tile(
            j.first_row + np.arange(j.rows), j.parts
        )
    np.add.at(D, (first, rows["node_a"]), rows["D"][index, :6])
    np.add.at(D, (first, rows["node_b"]), rows["D"][index, 6:])
    return D[whole_rows(joints)]


def null_space(D: np.ndarray) -> np.ndarray:
    """Orthonormal basis (n, k) of the null space of D (m, n); redundant rows count once."""
    return null_space_and_inverse(D)[0]


def null_space_and_inverse(D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The null space (n, k) of D (m, n), and its inverse (n, m) of least squares."""
    if not len(D):
        return np.eye(D.shape[1]), np.zeros((D.shape[1], 0))
    U, values, rows = np.linalg.svd(D, full_matrices=True)
    rank = int((values > 1e-9 * values.max(initial=0.0)).sum())
    inverse = (rows[:rank].T / values[:rank]) @ U[:, :rank].T
    return rows[rank:].T, inverse
