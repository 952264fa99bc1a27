"""Stability of an equilibrium: whether anything moves away from it by itself.

    x^T K x > 0   for every x with D x = 0

K is the tangent stiffness with geometric stiffness, D that of the joints. Where K is symmetric
its reduced form has a negative eigenvalue as soon as the equilibrium is unstable: beyond the load
at which a column buckles, or a shell snaps. Where loads follow the motion, or moments keep their
axis, K is not symmetric; an equilibrium then is left without vibration where an eigenvalue of
M^-1 K is real and negative; where one is complex vibrations grow unless they are damped (flutter),
which is reported. A factor L U shows an unstable mode by the signs of its pivots: one negative for
each row of a joint, and one for each unstable mode. Consequence to test: Euler's column is left at
pi^2 E I / 4 L^2.

References: Ziegler (1968), Principles of Structural Stability, 2; Bathe (1996), Finite Element
Procedures, 8.2 (signs of pivots).
"""

import numpy as np

from crashsolve.model.jacobian import null_space

# of the largest, with each row over the root of its diagonal: less is round-off, or nothing holds
NOTHING = 1e-12
# of the largest stiffness: smaller ones are scaled no further, or rows of D would lose their rank
SOFT = 1e-12
# asymmetry, of the largest entry, which differences leave; and of an eigenvalue of M^-1 K
SYMMETRY_TOLERANCE = 1e-5
# imaginary part of an eigenvalue, over its size, that differences do not make
FLUTTER = 1e-2


def unstable_mode(K: np.ndarray, D: np.ndarray, M: np.ndarray) -> tuple[np.ndarray | None, bool]:
    """The motion (n,) in which an equilibrium is left, None without; whether it may flutter.

    K and M (n, n), D (m, n).
    """
    if not null_space(D).size:
        # drivers hold all of it, and K is nothing but round-off
        return None, False
    size = np.sqrt(np.maximum(np.abs(np.diag(K)), SOFT * np.abs(K).max(initial=1e-300)))
    free = null_space(D / size)
    reduced = free.T @ (K / np.outer(size, size)) @ free
    if not reduced.size:
        return None, False
    largest = np.abs(reduced).max()
    if np.abs(reduced - reduced.T).max() <= SYMMETRY_TOLERANCE * largest:
        mode = _of_even(0.5 * (reduced + reduced.T), NOTHING * largest)
        flutters = False
    else:
        mode, flutters = _of_odd(reduced, free.T @ (M / np.outer(size, size)) @ free)
    return None if mode is None else free @ mode / size, flutters


def _of_even(K: np.ndarray, nothing: float) -> np.ndarray | None:
    """The unstable mode (n,) of a symmetric K, None without one."""
    try:
        np.linalg.cholesky(K + nothing * np.eye(len(K)))
    except np.linalg.LinAlgError:
        values, modes = np.linalg.eigh(K)
        return modes[:, 0] if values[0] < -nothing else None
    return None


def _of_odd(K: np.ndarray, M: np.ndarray) -> tuple[np.ndarray | None, bool]:
    """The unstable mode (n,) of any K, None without one, and whether vibrations grow."""
    eigenvalues, displacements = np.linalg.eig(np.linalg.solve(M, K))
    size = np.abs(eigenvalues)
    is_real = np.abs(eigenvalues.imag) <= SYMMETRY_TOLERANCE * size
    leaves = (eigenvalues.real < -NOTHING * size.max()) & is_real
    flutters = bool((np.abs(eigenvalues.imag) > FLUTTER * size).any())
    if not leaves.any():
        return None, flutters
    return displacements[
        :, int(np.argmin(np.where(leaves, eigenvalues.real, np.inf)))
    ].real, flutters


def unstable_modes(columns: np.ndarray) -> tuple[int, int]:
    """Number of unstable modes by the pivots of a factor, and the node of the most negative one.

    `columns` are those of foundation/sparse/bordered.py, after the nodes' have been factorised.
    """
    negative, worst, location = 0, 0.0, 0
    for c in columns:
        used = c["inverse"][: int(c["rows"])]
        used = used[used != 0.0]
        if c["node"] > 0:
            share = 1.0 / (used * c["pivot"][: len(used)])
            below = share < -NOTHING
            negative += int(below.sum())
            if below.any() and share.min() < worst:
                worst, location = float(share.min()), int(c["node"])
        else:
            # a row of a joint is a negative pivot, unless it holds an unstable mode
            negative -= int((used > 0.0).sum())
    return negative, location


def mass_matrix(nodes: np.ndarray) -> np.ndarray:
    """Mass matrix (6 n, 6 n) of nodes (n,), world axes."""
    n = len(nodes)
    M = np.zeros((n, 6, n, 6))
    A, J = nodes["A"].reshape(-1, 3, 3), nodes["J"].reshape(-1, 3, 3)
    M[np.arange(n), :3, np.arange(n), :3] = np.eye(3) / nodes["mass_inv"][:, None, None]
    M[np.arange(n), 3:, np.arange(n), 3:] = np.matmul(np.matmul(A, J), A.transpose(0, 2, 1))
    return M.reshape(6 * n, 6 * n)


def count_unstable(K: np.ndarray, D: np.ndarray) -> int:
    """Number of unstable modes of an equilibrium. K (n, n), D (m, n)."""
    size = np.sqrt(np.maximum(np.abs(np.diag(K)), SOFT * np.abs(K).max(initial=1e-300)))
    free = null_space(D / size)
    reduced = free.T @ (K / np.outer(size, size)) @ free
    if not reduced.size:
        return 0
    nothing = NOTHING * np.abs(reduced).max()
    if np.abs(reduced - reduced.T).max() <= SYMMETRY_TOLERANCE * np.abs(reduced).max():
        return int((np.linalg.eigvalsh(0.5 * (reduced + reduced.T)) < -nothing).sum())
    eigenvalues = np.linalg.eigvals(reduced)
    is_real = np.abs(eigenvalues.imag) <= SYMMETRY_TOLERANCE * np.abs(eigenvalues)
    return int(((eigenvalues.real < -nothing) & is_real).sum())
