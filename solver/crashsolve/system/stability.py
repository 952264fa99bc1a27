"""Stability of an equilibrium: whether anything moves away from it by itself.

    x^T K x > 0   for every x with D x = 0

K is the tangent stiffness with all that turns forces, D that of the joints. Where K is symmetric
its reduced form has a negative eigenvalue as soon as the equilibrium is unstable: beyond the load
at which a column buckles, or a shell snaps. Where loads follow the motion, or moments keep their
axis, K is not symmetric; an equilibrium then is left without vibration where an eigenvalue of
M^-1 K is real and negative. What vibrates and grows (flutter) is no matter of equilibria. A
factor L U shows the same by the signs of its pivots: one negative for each row of a joint, and one
for each way out. Consequence to test: Euler's column is left at pi^2 E I / 4 L^2.

References: Ziegler (1968), Principles of Structural Stability, 2; Bathe (1996), Finite Element
Procedures, 8.2 (signs of pivots).
"""

import numpy as np

# of the largest, with each row over the root of its diagonal: less is round-off, or nothing holds
NOTHING = 1e-12
# asymmetry, of the largest entry, which differences leave; and of an eigenvalue of M^-1 K
ALIKE = 1e-5


def way_out(K: np.ndarray, D: np.ndarray, M: np.ndarray) -> np.ndarray | None:
    """The motion (n,) in which an equilibrium is left; None where it is stable.

    K and M (n, n), D (m, n).
    """
    size = np.sqrt(np.maximum(np.abs(np.diag(K)), 1e-30 * np.abs(K).max(initial=1e-300)))
    free = _null_space(D / size)
    reduced = free.T @ (K / np.outer(size, size)) @ free
    if not reduced.size:
        return None
    even = 0.5 * (reduced + reduced.T)
    nothing = NOTHING * np.abs(even).max(initial=0.0)
    try:
        np.linalg.cholesky(even + nothing * np.eye(len(even)))
    except np.linalg.LinAlgError:
        pass
    else:
        return None
    if np.abs(reduced - reduced.T).max() <= ALIKE * np.abs(reduced).max():
        values, modes = np.linalg.eigh(even)
        mode = modes[:, 0]
        return free @ mode / size if values[0] < -nothing else None
    mass = free.T @ (M / np.outer(size, size)) @ free
    found, ways = np.linalg.eig(np.linalg.solve(mass, reduced))
    leaves = (found.real < -nothing * np.abs(found).max()) & (
        np.abs(found.imag) <= ALIKE * np.abs(found)
    )
    if not leaves.any():
        return None
    worst = int(np.argmin(np.where(leaves, found.real, np.inf)))
    return free @ ways[:, worst].real / size


def _null_space(D: np.ndarray) -> np.ndarray:
    """Orthonormal columns (n, k) that D (m, n) takes to nothing; redundant rows count once."""
    if not len(D):
        return np.eye(D.shape[1])
    _, values, rows = np.linalg.svd(D, full_matrices=True)
    rank = int((values > 1e-9 * values.max(initial=0.0)).sum())
    return rows[rank:].T


def ways_out(columns: np.ndarray) -> tuple[int, int]:
    """How many ways out the pivots of a factor show, and the node of the most negative one.

    `columns` are those of foundation/bordered.py, after the nodes' have been factorised.
    """
    negative, worst, place = 0, 0.0, 0
    for c in columns:
        used = c["inverse"][: int(c["rows"])]
        used = used[used != 0.0]
        if c["node"] > 0:
            share = 1.0 / (used * c["pivot"][: len(used)])
            below = share < -NOTHING
            negative += int(below.sum())
            if below.any() and share.min() < worst:
                worst, place = float(share.min()), int(c["node"])
        else:
            # a row of a joint is a negative pivot, unless it holds a way out
            negative -= int((used > 0.0).sum())
    return negative, place
