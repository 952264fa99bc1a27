"""Tangent of the elements of beams: changes of the forces on their ends by displacements and
rotations of these.

    dF = R (df - f x omega),   dM_a = R (dm' - dc - (m' - c) x omega),   dM_b = -R (dm' + ...)
    omega = w_0 - g x s,   dy = dr - omega x y,   dtheta = T s,   c = f x y / 2
    (df, dm) = U'' (dy, dtheta),   dm' = T dm + (dT) m + 2 (dg x c + g x dc)

in axes of R, with the spins s of b over a and w_0 of the mean (`corotational.py`): the whole
derivative, with present bending and rotation; U'' is that of the energy by y and theta. For
all elements at once, in numpy, for statics. Consequence to test: central differences
of the forces.

Reference: Crisfield (1990), A consistent co-rotational formulation for non-linear,
three-dimensional beam-elements, Computer Methods in Applied Mechanics and Engineering 81, 131-150.
"""

import numpy as np

from crashsolve.foundation.orientation import matrices, products
from crashsolve.foundation.rows import Table

# [rad] smaller rotations count as zero in T and g
SMALL = 1e-8


def forces_by_motions(
    p: Table, q_a: np.ndarray, q_b: np.ndarray, displacement: np.ndarray
) -> np.ndarray:
    """Derivatives (n, 12, 12) of force and moment on both ends by their positions and rotations.

    q_a and q_b (n, 4) are the orientations of the ends in the element's axes, vector (n, 3) from a
    to b, world axes; of a the first six of rows and columns.
    """
    R, y, theta = strains(q_a, q_b, displacement)
    slopes, bent, e = _stretch(p, y, theta)
    axial, shear = p["stiffness"][:, 0], p["stiffness"] * [0.0, 1.0, 1.0]
    N = axial * e
    f = N[:, None] * slopes[:, :3] + shear * y
    m = N[:, None] * slopes[:, 3:] + p["rotational_stiffness"] * theta
    # by the strains y and theta: of shear and bending, then of the stretch
    own = np.hstack([shear, p["rotational_stiffness"]])[:, :, None] * np.eye(6)
    own += N[:, None, None] * bent + axial[:, None, None] * slopes[:, :, None] * slopes[:, None]
    return by_motions(R, y, theta, f, m, own)


def strains(
    q_a: np.ndarray, q_b: np.ndarray, displacement: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """R (n, 3, 3), y and theta (n, 3) of elements with these orientations and distances of the
    ends.
    """
    R, theta = _halfway(q_a, q_b)
    return R, np.einsum("nji,nj->ni", R, displacement), theta


def by_motions(
    R: np.ndarray,
    y: np.ndarray,
    theta: np.ndarray,
    f: np.ndarray,
    m: np.ndarray,
    own: np.ndarray,
) -> np.ndarray:
    """Derivatives (n, 12, 12) of the forces on both ends by f and m (n, 3).

    `own` (n, 6, 6) are those of f and m by y and theta.
    """
    T, dT, g, dg = _rotating(theta, m)
    omega, dy, d_theta = _changes(R, y, T, g)
    c = 0.5 * np.cross(f, y)
    moment = np.einsum("nij,nj->ni", T, m) + 2.0 * np.cross(g, c)
    df, dm = np.split(own @ np.concatenate([dy, d_theta], 1), 2, axis=1)
    dc = 0.5 * (skew(f) @ dy - skew(y) @ df)
    dm = T @ dm + dT @ d_theta + 2.0 * (skew(g) @ dc - skew(c) @ dg @ d_theta)
    force = R @ (df - skew(f) @ omega)
    on_a = R @ (dm - dc - skew(moment - c) @ omega)
    on_b = -R @ (dm + dc - skew(moment + c) @ omega)
    return np.concatenate([force, on_a, -force, on_b], axis=1)


def _stretch(p: Table, y: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, ...]:
    """Slopes (n, 6) of the stretch e by y and theta, their derivatives (n, 6, 6), and e (n,)."""
    d = np.linalg.norm(y, axis=1)[:, None]
    n, rotations, no_displacement = y / d, theta * [0.0, 1.0, 1.0], np.zeros_like(y)
    C = np.hstack([no_displacement[:, :1], 2.0 * p["bowing"]])
    h = C * n
    by_rotations, half = 1.0 + (rotations**2).sum(1)[:, None] / 24.0, 0.5 * (h * n).sum(1)[:, None]
    slopes = np.hstack([(by_rotations - half) * n + h, d / 12.0 * rotations])
    across = (np.eye(3) - n[:, :, None] * n[:, None]) / d[:, :, None]
    bends = n[:, :, None] * rotations[:, None] / 12.0
    dn = (by_rotations - half)[:, :, None] * across + C[:, :, None] * across
    dn -= n[:, :, None] * (h[:, None] @ across)
    by_rotation = d[:, :, None] / 12.0 * np.diag([0.0, 1.0, 1.0])
    both = np.block([[dn, bends], [bends.transpose(0, 2, 1), by_rotation]])
    return slopes, both, (d * (by_rotations + half))[:, 0] - p["length"]


def slopes_of_strains(R: np.ndarray, y: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Derivatives (n, 6, 12) of y and theta by the motions of both ends."""
    T, _, g, _ = _rotating(theta, theta)
    return np.concatenate(_changes(R, y, T, g)[1:], 1)


def _changes(
    R: np.ndarray, y: np.ndarray, T: np.ndarray, g: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """omega, dy and dtheta (n, 3, 12) of each motion of both ends."""
    to, none = R.transpose(0, 2, 1), np.zeros_like(R)
    dr, s = np.concatenate([-to, none, to, none], 2), np.concatenate([none, -to, none, to], 2)
    omega = np.concatenate([none, 0.5 * to, none, 0.5 * to], 2) - skew(g) @ s
    return omega, dr + skew(y) @ omega, T @ s


def skew(v: np.ndarray) -> np.ndarray:
    """Matrices (n, 3, 3) of the cross product with v (n, 3)."""
    x, y, z = v.T
    none = np.zeros_like(x)
    return np.array([[none, -z, y], [z, none, -x], [-y, x, none]]).transpose(2, 0, 1)


def _rotating(theta: np.ndarray, m: np.ndarray) -> tuple[np.ndarray, ...]:
    """T, the derivative of T m by theta at constant m, g, and the derivative of g by theta."""
    angle = np.linalg.norm(theta, axis=1)[:, None, None]
    rotation, is_small = np.maximum(angle, SMALL), angle < SMALL
    half, n = 0.5 * rotation, theta / rotation[:, 0]
    eta = half / np.sin(half)
    slope = (np.sin(half) - half * np.cos(half)) / np.sin(half) ** 2
    along, unit = n[:, :, None] * n[:, None], np.eye(3)
    across = unit - along
    T = np.where(is_small, unit, eta * across + along)
    m_along, m_across = (n * m).sum(1)[:, None, None], (across @ m[:, :, None])
    bent = (1.0 - eta) / rotation * (m_along * across + n[:, :, None] * m_across.transpose(0, 2, 1))
    dT = np.where(is_small, 0.0, 0.5 * slope * m_across * n[:, None] + bent)
    quarter = np.tan(0.5 * half)
    dg = 0.125 * (1.0 + quarter**2) * along + 0.5 * quarter / rotation * across
    return T, dT, 0.5 * quarter[:, 0] * n, dg


def _halfway(q_a: np.ndarray, q_b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R (n, 3, 3) half-way between both triads, and theta (n, 3) from one to the other in it."""
    rotation = products(q_a * [1.0, -1.0, -1.0, -1.0], q_b)
    rotation *= np.where(rotation[:, :1] < 0.0, -1.0, 1.0)
    w, v = rotation[:, :1], rotation[:, 1:]
    sine = np.linalg.norm(v, axis=1)[:, None]
    eta = np.where(sine > SMALL, np.arctan2(sine, w) / np.maximum(sine, SMALL), 1.0)
    half = np.hstack([1.0 + w, v]) / np.sqrt(2.0 + 2.0 * w)
    return matrices(products(q_a, half)), 2.0 * eta * v
