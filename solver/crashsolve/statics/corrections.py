"""Corrections towards an equilibrium, by matrices that serve the configurations near one.

    (M / tau^2 - G) projected on Z, times y = Z^T (g + G delta_c),   delta = delta_c + Z y

g (6 n,) are forces at rest, G = dg/dq, D delta_c = -Phi closes the joints, D Z = 0. Matrices serve
further configurations as long as G predicts how forces change there: the motion by which a
correction misses the prediction is Deuflhard's contraction factor. Consequence to test: an
equilibrium does not depend on how often the matrices were renewed.

Reference: Deuflhard (2011), Newton Methods for Nonlinear Problems, Springer, sections 2.1 and 3.2.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crashsolve.model.jacobian import null_space_and_inverse
from crashsolve.statics.motions import largest_motion
from crashsolve.statics.stability import SYMMETRY_TOLERANCE

# growth of a motion away from the equilibrium beyond that of round-off [1/s]
GROWTH, ROUND_OFF = 0.1, 1e-9


@dataclass
class RestState:
    """A configuration at rest: g (6 n,), D (m, 6 n), Phi (m,) and accelerations (n, 6)."""

    g: np.ndarray
    D: np.ndarray
    phi: np.ndarray
    rates: np.ndarray

    @property
    def largest_acceleration(self) -> float:
        return float(np.abs(self.rates).max(initial=0.0))


class Matrices:
    """Matrices of a state: Z (6 n, k), motions that its joints allow, K and M projected on them."""

    def __init__(self, state: RestState, G: np.ndarray, M: np.ndarray) -> None:
        self.state, self.G = state, G
        self.Z, self.closing = null_space_and_inverse(state.D)
        self.K, self.M = -self.Z.T @ G @ self.Z, self.Z.T @ M @ self.Z

    @cached_property
    def half(self) -> np.ndarray:
        """Scales K to squares of frequencies."""
        return np.linalg.inv(np.linalg.cholesky(0.5 * (self.M + self.M.T)))

    @cached_property
    def time_of_growth(self) -> float:
        """Half the time [s] in which the fastest motion away from here grows by e; 0 for none.

        A longer pseudo time step would lead up to an unstable equilibrium. Loads that follow the
        motion have no potential, and no such time.
        """
        if not self.K.size or _is_positive(self.K):
            return 0.0
        K = self.half @ self.K @ self.half.T
        values = np.linalg.eigvalsh(0.5 * (K + K.T))
        limit = max(GROWTH**2, ROUND_OFF * values[-1])
        is_even = np.abs(K - K.T).max() <= SYMMETRY_TOLERANCE * np.abs(values).max()
        return float(0.5 / np.sqrt(-values[0])) if values[0] < -limit and is_even else 0.0

    def inverse(self, tau: float, drifts: bool) -> np.ndarray:
        """Inverse of M / tau^2 + K; with `drifts`, but for motions that nothing holds."""
        limit = 0.0 if drifts else self.time_of_growth
        rate = 1.0 / (min(tau, limit) if limit > 0.0 else tau) ** 2
        if not drifts:
            # not from modes: those of light bodies leave neutral ones too little accuracy
            return np.linalg.pinv(rate * self.M + self.K, rcond=1e-15)
        # such motions keep their coordinates
        U, values, V = np.linalg.svd(self.half @ (rate * self.M + self.K) @ self.half.T)
        # where U and V are opposite, forces drive the motion on
        kept = values * (U.T * V).sum(axis=1) > rate + GROWTH**2
        inverse = V[kept].T @ ((U[:, kept] / values[kept]).T)
        return np.asarray(self.half.T @ inverse @ self.half)


class Corrections:
    """Corrections by the matrices of one state with one pseudo time step `tau` [s]."""

    def __init__(self, matrices: Matrices, tau: float, drifts: bool, size: float) -> None:
        """With `drifts` for a model in which nothing holds a motion; `size` of the model [m]."""
        self.matrices, self.tau, self.drifts, self.size = matrices, tau, drifts, size
        self._inverse = matrices.inverse(tau, drifts)

    def changed(self, tau: float, drifts: bool) -> "Corrections":
        """Those with another time step, by the same matrices."""
        if tau == self.tau and drifts == self.drifts:
            return self
        return Corrections(self.matrices, tau, drifts, self.size)

    def of(self, state: RestState) -> np.ndarray:
        """The correction (n, 6) of a state."""
        closing = -self.matrices.closing @ state.phi
        free = self._free(state.g + self.matrices.G @ closing)
        return np.asarray((closing + free).reshape(-1, 6))

    def contraction(self, before: RestState, change: np.ndarray, after: RestState) -> float:
        """Motion by which G misses the forces `after` a change (n, 6), over that change.

        With the same matrices, corrections of later iterations fall by this factor.
        """
        missed = after.g - before.g - self.matrices.G @ change.ravel()
        far = largest_motion(self._free(missed).reshape(-1, 6), self.size)
        return far / max(largest_motion(change, self.size), 1e-300)

    def _free(self, g: np.ndarray) -> np.ndarray:
        Z = self.matrices.Z
        return np.asarray(Z @ (self._inverse @ (Z.T @ g)))


def _is_positive(K: np.ndarray) -> bool:
    try:
        np.linalg.cholesky(0.5 * (K + K.T))
    except np.linalg.LinAlgError:
        return False
    return True
