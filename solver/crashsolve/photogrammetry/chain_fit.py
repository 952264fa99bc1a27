"""A chain of bodies fitted to the points of a frame by least squares under its joints.

    minimise  e^T S^-1 e + sum (q_j / s_j)^2,   e = x_measured - x(q),   S = S_points + s_l^2 I

q are position and rotation of the root and the rotations of joints: a rotation vector of a joint
that turns about any axis, an angle of one with an axis, within the stops of the deck; s_l is the
spread of landmarks, s_j that of joints near the zero posture by the request. The
covariance of q is (J^T J)^-1 with the Jacobian J of the weighted residuals; a direction of q that
neither points nor spreads determine within a radian is refused.
Consequence to test: e^T S^-1 e at the minimum is chi-squared, and so are errors of q over their
covariance.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import ceil
from typing import Any

import numpy as np

from crashsolve.foundation.orientation import matrix, quaternion_of
from crashsolve.photogrammetry.points import Frame
from crashsolve.postures._chain import Link, Motion, next_body

Array = np.ndarray
# evaluations of one search; those that converge take some ten
MAX_EVALUATIONS = 300
# changes of the sum of squares and of q, over both, that end a search, and that of its minimum
SEARCHED, CONVERGED = 1e-6, 1e-12
# distances of points on one body over those of its landmarks: people and noise differ by less,
# units of length by ten and more
SAME_UNIT = 4.0
# a rotation that is not known within this is not determined [rad]; of a position in metres as well
UNDETERMINED = 1.0


class FitError(Exception):
    """Points that do not determine a chain; the message has the cause, `advice` the remedy."""

    def __init__(self, message: str, advice: str = "") -> None:
        super().__init__(message)
        self.advice = advice


@dataclass(frozen=True)
class Chain:
    """The chain that is fitted: links in order from the root, landmarks, stops and spreads of
    joints.
    """

    root: int
    root_name: str
    links: tuple[Link, ...]
    landmarks: dict[str, tuple[int, Array]]  # node, and arm from its mass centre in its axes
    zero: Motion  # of the root
    stops: dict[str, tuple[float, float]]
    spreads: dict[str, float]

    def widths(self) -> list[int]:
        """Unknowns of each link."""
        return [3 if one.axis is None else 1 for one in self.links]

    def labels(self) -> list[str]:
        """Label of each unknown."""
        joints = zip(self.links, self.widths(), strict=True)
        return [self.root_name] * 6 + [one.joint for one, n in joints for _ in range(n)]

    def split(self, q: Array) -> list[Array]:
        """Unknowns of each link."""
        return np.split(q[6:], np.cumsum(self.widths())[:-1])

    def placed(self, q: Array) -> dict[int, Motion]:
        """All bodies; without velocities."""
        rest = np.zeros(3)
        placed = {self.root: Motion(rotation(q[3:6]), q[:3], rest, rest)}
        for one, own in zip(self.links, self.split(q), strict=True):
            next_body(one, rotation(own if one.axis is None else own * one.axis), rest, placed)
        return placed

    def points(self, q: Array, names: Sequence[str]) -> Array:
        """Landmarks (n, 3) by their names."""
        placed = self.placed(q)
        marks = [self.landmarks[name] for name in names]
        return np.array([placed[node].x + placed[node].A @ arm for node, arm in marks])


@dataclass(frozen=True)
class Fit:
    """The chain at a moment: unknowns, and how well they meet the points.

    The covariance is that of positions and of small rotations about the axes of a.
    """

    time: float
    q: Array
    covariance: Array
    distances: Array  # (n,) from the points to their landmarks
    chi_squared: float
    freedom: int


def rotation(vector: Array) -> Array:
    """Matrix (3, 3) of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    half = 0.5 * np.sinc(0.5 * angle / np.pi)
    return matrix((np.cos(0.5 * angle), *(half * vector)))


def rotation_vector(A: Array) -> Array:
    """Rotation vector (3,) of a matrix, at most pi long."""
    q = quaternion_of(A)
    q = -q if q[0] < 0.0 else q
    sine = float(np.linalg.norm(q[1:]))
    angle = 2.0 * np.arctan2(sine, q[0])
    vector: Array = q[1:] * (angle / sine if sine > 0.0 else 2.0)
    return vector


def fit(chain: Chain, frame: Frame, landmark_error: float, before: Array | None) -> Fit:
    """The posture at a frame, searched from that before, or from several. Raises FitError."""
    names = [point.name for point in frame.points]
    measured = np.concatenate([point.x for point in frame.points])
    S = frame.covariance + landmark_error**2 * np.eye(len(measured))
    count, unknowns = len(measured), len(chain.labels())
    known = [s for one, n in zip(chain.links, chain.widths(), strict=True)
             for s in [chain.spreads.get(one.joint, np.inf)] * n]  # fmt: skip
    weights = np.concatenate([np.zeros(6), 1.0 / np.array(known)])
    _check_count(count, unknowns, int(np.count_nonzero(weights)), len(names))
    _check_unit(chain, names, measured.reshape(-1, 3))
    whitening = np.linalg.inv(np.linalg.cholesky(S))

    def residuals(q: Array) -> Array:
        e = measured - chain.points(q, names).ravel()
        return np.concatenate([whitening @ e, (weights * q)[weights > 0.0]])

    starts = _starts(chain, names, measured) if before is None else [before]
    freedom = count + int(np.count_nonzero(weights)) - unknowns
    q, J = _best(residuals, starts, _bounds(chain), freedom)
    to_rotations = _rotation_jacobian(chain, q)
    covariance = to_rotations @ _covariance(chain, J, names) @ to_rotations.T
    e = (measured - chain.points(q, names).ravel()).reshape(-1, 3)
    squares = float(residuals(q) @ residuals(q))
    return Fit(frame.time, q, covariance, np.linalg.norm(e, axis=1), squares, freedom)


def _check_count(count: int, unknowns: int, spreads: int, points: int) -> None:
    needed = ceil((unknowns - spreads) / 3)
    if points < needed:
        raise FitError(
            f"{points} points are seen, {count} coordinates for {unknowns - spreads} unknowns",
            f"at least {needed} points are needed",
        )


def _check_unit(chain: Chain, names: Sequence[str], measured: Array) -> None:
    """Points of another unit of length would not be met however long the search is."""
    own = far = 0.0
    for i, j in combinations(range(len(names)), 2):
        (body, x), (other, y) = chain.landmarks[names[i]], chain.landmarks[names[j]]
        if body == other:
            own += float(np.linalg.norm(x - y))
            far += float(np.linalg.norm(measured[i] - measured[j]))
    if own > 0.0 and not own / SAME_UNIT < far < own * SAME_UNIT:
        raise FitError(
            f"points are {far / own:.3g} times as far apart as the landmarks of their bodies",
            "look for wrong units of the targets or the landmarks",
        )


def _best(
    residuals: object, starts: list[Array], bounds: tuple[Array, Array], freedom: int
) -> tuple[Array, Array]:
    """The first minimum within the errors, or the least, and its Jacobian. Raises FitError."""
    from scipy.optimize import least_squares

    lower, upper = bounds

    def search(start: Array, tolerance: float) -> Any:
        # just within the stops, where a search must begin
        inner = np.clip(start, lower + 1e-6, upper - 1e-6)
        return least_squares(
            residuals,
            inner,
            "3-point",
            bounds,
            x_scale="jac",
            xtol=tolerance,
            ftol=tolerance,
            max_nfev=MAX_EVALUATIONS,
        )

    fits = []
    for start in starts:
        fits.append(search(start, SEARCHED))
        # chi-squared of this freedom, four standard deviations over its mean
        if 2.0 * fits[-1].cost <= freedom + 4.0 * np.sqrt(2.0 * freedom):
            break
    best = search(min(fits, key=lambda one: one.cost).x, CONVERGED)
    if not best.success or not np.all(np.isfinite(best.x)):
        raise FitError("the search for the posture does not converge")
    return best.x, best.jac


def _bounds(chain: Chain) -> tuple[Array, Array]:
    pairs = [(-np.inf, np.inf)] * 6
    for one in chain.links:
        free = [(-np.inf, np.inf)] * (3 if one.axis is None else 1)
        pairs += [chain.stops[one.joint]] if one.joint in chain.stops else free
    return np.array([low for low, _ in pairs]), np.array([high for _, high in pairs])


def _starts(chain: Chain, names: Sequence[str], measured: Array) -> list[Array]:
    """The zero posture and others, each moved as one body as near to the points as it goes."""
    rng = np.random.default_rng(1)
    n = sum(chain.widths())
    lower, upper = (side[6:] for side in _bounds(chain))
    others = [rng.uniform(np.maximum(lower, -1.2), np.minimum(upper, 1.2)) for _ in range(7)]
    starts = []
    for angles in [np.zeros(n), *others]:
        q = np.concatenate([chain.zero.x, rotation_vector(chain.zero.A), angles])
        x, y = chain.points(q, names), measured.reshape(-1, 3)
        R = _nearest_rotation(x - x.mean(axis=0), y - y.mean(axis=0))
        origin = y.mean(axis=0) + R @ (q[:3] - x.mean(axis=0))
        turned = rotation_vector(R @ rotation(q[3:6]))
        starts.append(np.concatenate([origin, turned, angles]))
    return starts


def _nearest_rotation(x: Array, y: Array) -> Array:
    """R (3, 3) for which R x (n, 3) is nearest to y: Kabsch (1976), Acta Cryst. A32, 922-923."""
    U, _, V = np.linalg.svd(x.T @ y)
    sign = np.sign(np.linalg.det(U @ V))
    rotation: Array = (V.T * [1.0, 1.0, sign]) @ U.T
    return rotation


def _covariance(chain: Chain, J: Array, names: Sequence[str]) -> Array:
    """(J^T J)^-1. Raises FitError naming the unknowns that are not determined."""
    _, s, V = np.linalg.svd(J, full_matrices=False)
    loose = [k for k in range(len(s)) if not s[k] * UNDETERMINED > 1.0]
    if loose:
        labels = chain.labels()
        joints = dict.fromkeys(labels[int(np.argmax(np.abs(V[k])))] for k in loose)
        absent = [name for name in chain.landmarks if name not in names]
        advice = f"at least {ceil(len(loose) / 3)} more of {', '.join(absent)}" if absent else ""
        joint = next(iter(joints))
        more = f"a spread of '{joint}'" if joint != chain.root_name else "other points"
        raise FitError(
            f"the {len(names)} points leave {len(loose)} of {len(labels)} unknowns open: rotation "
            f"at {', '.join(joints)}",
            f"give {' or '.join(filter(None, (advice, more)))}",
        )
    covariance: Array = (V.T / s**2) @ V
    return covariance


def _rotation_jacobian(chain: Chain, q: Array) -> Array:
    """Matrices from changes of q to small rotations: about axes of a, of the root about the
    world's.
    """
    matrix = np.eye(len(q))
    matrix[3:6, 3:6] = _left_jacobian(q[3:6])
    first = 6
    for one, own in zip(chain.links, chain.split(q), strict=True):
        if one.axis is None:
            matrix[first : first + 3, first : first + 3] = _left_jacobian(own)
        first += len(own)
    return matrix


def _left_jacobian(vector: Array) -> Array:
    """Left Jacobian (3, 3) of a rotation vector:

    Chirikjian (2012), Stochastic Models 2, chapter 10.
    """
    angle = float(np.linalg.norm(vector))
    if angle < 1e-8:
        return np.eye(3)
    x, y, z = vector / angle
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle) / angle, (1.0 - np.cos(angle)) / angle
    return np.eye(3) + cosine * skew + (1.0 - sine) * skew @ skew
