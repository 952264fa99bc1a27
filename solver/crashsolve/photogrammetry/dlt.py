"""Direct linear transformation: from a point to its image and back, with first-order covariances.

    u = (L1 x + L2 y + L3 z + L4) / w,   v = (L5 x + L6 y + L7 z + L8) / w,
    w = L9 x + L10 y + L11 z + 1

Calibration finds the eleven L of a camera from known points and their images, reconstruction a
point from its images. Both solve these equations, multiplied by w, by least squares (the
original); for the calibration `normalised` takes the null vector of the homogeneous equations
instead, with points and images moved to their mean and divided by their standard deviation. A
point is never found by a null vector, which would depend on the unit of length. Residuals of the
multiplied equations are w times those of the images, so an error e of the images moves L or x by
-B^+ w e with the pseudo-inverse B^+ of the equations: that is the covariance.
It is the first order in e, and holds where e changes B itself by little (`nonlinearity`).
Consequence to test: over many draws of e, errors divided by that covariance are chi-squared.

References: Abdel-Aziz and Karara (1971), ASP Symposium on Close-Range Photogrammetry, 1-18; Hartley
(1997), IEEE Trans. Pattern Analysis and Machine Intelligence 19(6), 580-593 (normalisation).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

Method = Literal["normalised", "least_squares"]
Array = np.ndarray
UNKNOWNS = 11
FEWEST = 6
# condition of equations that do not determine a camera or a point, with columns of one length
SINGULAR = 1e10


@dataclass(frozen=True)
class Camera:
    """A calibrated camera. `spread` is the covariance of L for images of unit variance."""

    L: Array  # (11,)
    spread: Array  # (11, 11)
    residuals: Array  # (n, 2) of the targets, image units
    closure: float  # chi-squared of 2n - 11, for images of unit variance


def image_of(L: Array, x: Array) -> Array:
    """Images (..., 2) of points (..., 3)."""
    H = np.append(L, 1.0).reshape(3, 4)
    h = x @ H[:, :3].T + H[:, 3]
    return h[..., :2] / h[..., 2:]


def depth_factor(L: Array, x: Array) -> Array:
    """w (...) of points (..., 3): of one sign before the camera."""
    factors: Array = x @ L[8:] + 1.0
    return factors


def flatness(x: Array) -> float:
    """Smallest over largest extent of points (n, 3): 0 where they lie in a plane."""
    s = np.linalg.svd(x - x.mean(axis=0), compute_uv=False)
    return float(s[-1] / s[0]) if s[0] > 0.0 else 0.0


def calibrate(x: Array, u: Array, method: Method) -> Camera:
    """A camera from targets (n, 3) and their images (n, 2).

    Raises: numpy.linalg.LinAlgError where they do not determine it.
    """
    L = _normalised(x, u) if method == "normalised" else _plain(x, u)
    if not np.all(np.isfinite(L)):
        raise np.linalg.LinAlgError("the world's origin lies in the plane of the camera")
    A, w = _rows(x, u)[:, :UNKNOWNS], np.repeat(depth_factor(L, x), 2)
    if np.linalg.cond(A / np.linalg.norm(A, axis=0)) > SINGULAR:
        raise np.linalg.LinAlgError("its targets do not determine it; give more, spread in space")
    by_images = _pseudo_inverse(A) * w
    closure = _chi_squared(A, A @ L - u.ravel(), np.diag(w**2))
    return Camera(L, by_images @ by_images.T, u - image_of(L, x), closure)


def reconstruct(L: Array, u: Array) -> Array:
    """A point (3,) from the transformations (k, 11) of cameras and its images (k, 2).

    Raises: numpy.linalg.LinAlgError where all see it along one line.
    """
    B, c = _equations(L, u)
    if np.linalg.cond(B / np.linalg.norm(B, axis=0)) > SINGULAR:
        raise np.linalg.LinAlgError("its cameras see it along one line")
    return _least_squares(B, c)


def sensitivities(L: Array, x: Array) -> tuple[Array, Array]:
    """Derivatives of a reconstructed point by its images (3, 2k), and by the L of these (3,
    11k).
    """
    u = np.array([image_of(one, x) for one in L])
    inverse = _pseudo_inverse(_equations(L, u)[0])
    return inverse * _factors(L, x), -inverse @ _by_cameras(x, u)


def nonlinearity(L: Array, x: Array, spread: Array) -> float:
    """Change of the equations of a point by errors of unit variance, over the equations themselves.

    It is |dB B^+| (Frobenius) of the rows B / w, root mean square over the errors of images and of
    all L, whose covariance is `spread`. First-order covariances need a small value.
    """
    u = np.array([image_of(one, x) for one in L])
    w = _factors(L, x)
    B = _equations(L, u)[0] / w[:, None]
    inverse = _pseudo_inverse(B)
    squares = 0.0
    for row in range(2 * len(L)):
        k, j = divmod(row, 2)
        own = spread[UNKNOWNS * k : UNKNOWNS * (k + 1), UNKNOWNS * k : UNKNOWNS * (k + 1)]
        # changes of a row by its camera, of which w changes too, and by its image
        by_camera = np.zeros((3, UNKNOWNS))
        by_camera[:, 4 * j : 4 * j + 3] = np.eye(3)
        by_camera[:, 8:] -= u[k, j] * np.eye(3) + np.outer(B[row], x)
        covariance = by_camera @ own @ by_camera.T + np.outer(L[k, 8:], L[k, 8:])
        squares += float(np.trace(inverse.T @ covariance @ inverse)) / w[row] ** 2
    return float(np.sqrt(squares))


def closure_of_point(L: Array, u: Array, x: Array, spread: Array) -> float:
    """Chi-squared of 2k - 3 of a point's images of unit variance; `spread` is that of all L."""
    B, c = _equations(L, u)
    by_cameras = _by_cameras(x, u)
    return _chi_squared(
        B, B @ x - c, np.diag(_factors(L, x) ** 2) + by_cameras @ spread @ by_cameras.T
    )


def _factors(L: Array, x: Array) -> Array:
    """w (2k) of the equations of a point."""
    return np.repeat([float(depth_factor(one, x)) for one in L], 2)


def _by_cameras(x: Array, u: Array) -> Array:
    """Derivatives of the equations of a point by the L of its cameras (2k, 11k)."""
    k = len(u)
    matrix = np.zeros((2 * k, UNKNOWNS * k))
    for i in range(k):
        rows = _rows(x[None], u[i : i + 1])[:, :UNKNOWNS]
        matrix[2 * i : 2 * i + 2, UNKNOWNS * i : UNKNOWNS * (i + 1)] = rows
    return matrix


def _chi_squared(B: Array, misclosure: Array, S: Array) -> float:
    """Chi-squared of the residuals of equations with the covariance S."""
    left = np.linalg.qr(B / np.linalg.norm(B, axis=0), mode="complete")[0][:, B.shape[1] :]
    z = left.T @ misclosure
    return float(z @ np.linalg.solve(left.T @ S @ left, z))


def _rows(x: Array, u: Array) -> Array:
    """Equations (2n, 12) of calibration: the first eleven columns for L, then -u, -v."""
    n = len(x)
    h = np.column_stack([x, np.ones(n)])
    rows = np.zeros((2 * n, 12))
    for j in (0, 1):
        rows[j::2, 4 * j : 4 * j + 4] = h
        rows[j::2, 8:] = -u[:, j, None] * h
    return rows


def _plain(x: Array, u: Array) -> Array:
    return _least_squares(_rows(x, u)[:, :UNKNOWNS], u.ravel())


def _normalised(x: Array, u: Array) -> Array:
    T_x, T_u = _normalisation(x), _normalisation(u)
    null = np.linalg.svd(_rows(_moved(T_x, x), _moved(T_u, u)))[2][-1]
    H = np.linalg.inv(T_u) @ null.reshape(3, 4) @ T_x
    with np.errstate(divide="ignore", invalid="ignore"):
        normalised: Array = (H / H[2, 3]).ravel()[:UNKNOWNS]
    return normalised


def _normalisation(points: Array) -> Array:
    """Matrix that moves points (n, d) to their mean and divides by their standard deviation."""
    d = points.shape[1]
    T = np.eye(d + 1)
    T[:d, d] = -points.mean(axis=0)
    T[:d] /= points.std()
    return T


def _moved(T: Array, points: Array) -> Array:
    d = points.shape[1]
    moved: Array = points @ T[:d, :d].T + T[:d, d]
    return moved


def _equations(L: Array, u: Array) -> tuple[Array, Array]:
    """B (2k, 3) and c (2k) of B x = c."""
    last = np.column_stack([L[:, 8:], np.ones(len(L))])
    rows = (L[:, :8].reshape(-1, 2, 4) - u[:, :, None] * last[:, None]).reshape(-1, 4)
    return rows[:, :3], -rows[:, 3]


def _pseudo_inverse(B: Array) -> Array:
    """B^+, with columns of one length: units differ by powers of ten."""
    scale = np.linalg.norm(B, axis=0)
    inverse: Array = np.linalg.pinv(B / scale) / scale[:, None]
    return inverse


def _least_squares(B: Array, c: Array) -> Array:
    scale = np.linalg.norm(B, axis=0)
    solution: Array = np.linalg.lstsq(B / scale, c, rcond=None)[0] / scale
    return solution
