"""Linear equations of some hundred rows, by elimination with pivots."""

import numpy as np

# of the largest entry: a smaller pivot is round-off, and something moves freely
SINGULAR = 1e-15


def eliminate(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solutions of A x = b (n,) or (n, k), not numbers where A is singular. Writes: A, b.

    LAPACK would wake threads that spin on a busy machine, for a matrix of some hundred rows.
    """
    size = np.abs(A).max(initial=0.0)
    for k in range(len(b)):
        pivot = k + int(np.argmax(np.abs(A[k:, k])))
        if not abs(A[pivot, k]) > SINGULAR * size:
            return np.full_like(b, np.nan)
        A[[k, pivot]], b[[k, pivot]] = A[[pivot, k]], b[[pivot, k]]
        # few rows of a chain have anything in a column
        below = k + 1 + np.flatnonzero(A[k + 1 :, k])
        factor = A[below, k] / A[k, k]
        A[below, k:] -= factor[:, None] * A[k, k:]
        b[below] -= np.multiply.outer(factor, b[k])
    for k in range(len(b) - 1, -1, -1):
        b[k] = (b[k] - np.einsum("i,i...->...", A[k, k + 1 :], b[k + 1 :])) / A[k, k]
    return b
