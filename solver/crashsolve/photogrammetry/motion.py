"""Velocities at a frame: through the frames about it, a parabola of every unknown of the chain.

    q(t) = q_0 + q_1 t + q_2 t^2,   the rate is q_1 at t = 0, the time of the frame

Rotations are measured from that of the frame itself, as rotation vectors in axes of a (of the root
in world axes), so that q_1 is an angular velocity. With two frames a straight line serves, with one
all is at rest. The covariance of q_1 is that of the frames, taken as independent: the errors of
cameras, which all frames share, hardly change a difference. More than three frames that lie on no
parabola within their errors are refused: a shorter window is needed.
Consequence to test: a motion with constant acceleration has its exact velocity.
"""

from dataclasses import dataclass

import numpy as np

from crashsolve.photogrammetry.chain_fit import Chain, Fit, FitError, rotation, rotation_vector
from crashsolve.photogrammetry.points import IMPROBABLE

Array = np.ndarray


@dataclass(frozen=True)
class Rates:
    """Rates of the unknowns with standard deviations: velocity, angular velocities, rates."""

    values: Array
    deviations: Array
    frames: int


def rates(chain: Chain, fits: list[Fit], at: int, window: int) -> Rates:
    """Rates at one of the frames. Raises FitError."""
    first = min(max(at - window // 2, 0), max(len(fits) - window, 0))
    own = fits[first : first + window]
    n = len(fits[at].q)
    if len(own) == 1:
        return Rates(np.zeros(n), np.full(n, np.inf), 1)
    t = np.array([one.time - fits[at].time for one in own])
    # coefficients by powers of t over the longest of them, so that columns are of one size
    scale = np.abs(t).max()
    powers = (t / scale)[:, None] ** np.arange(min(3, len(own)))
    weights = np.linalg.pinv(powers)[1] / scale
    changes = np.array([_change(chain, fits[at].q, one.q) for one in own])
    _check_parabola(powers, changes, np.mean([one.covariance for one in own], axis=0))
    variances = np.array([np.diag(one.covariance) for one in own])
    return Rates(weights @ changes, np.sqrt(weights**2 @ variances), len(own))


def _check_parabola(powers: Array, changes: Array, covariance: Array) -> None:
    """Refuse changes (frames, unknowns) that are no parabola. Raises FitError."""
    from scipy.stats import chi2

    left = changes - powers @ np.linalg.pinv(powers) @ changes
    freedom = (len(powers) - powers.shape[1]) * changes.shape[1]
    chi_squared = float(np.sum(left * np.linalg.solve(covariance, left.T).T))
    if freedom > 0 and chi2.sf(chi_squared, freedom) < IMPROBABLE:
        raise FitError(
            f"the motion through {len(powers)} frames is no parabola within its errors: "
            f"chi-squared is {chi_squared:.4g} of {freedom}",
            "give a shorter window",
        )


def _change(chain: Chain, q_0: Array, q: Array) -> Array:
    """Difference of unknowns, of rotations as rotation vectors."""
    changes = [q[:3] - q_0[:3], rotation_vector(rotation(q[3:6]) @ rotation(q_0[3:6]).T)]
    for one, new, old in zip(chain.links, chain.split(q), chain.split(q_0), strict=True):
        if one.axis is None:
            changes.append(rotation_vector(rotation(new) @ rotation(old).T))
        else:
            changes.append(new - old)
    return np.concatenate(changes)
