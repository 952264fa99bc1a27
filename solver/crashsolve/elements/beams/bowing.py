"""Stretch of an element of a beam that bends: the resistance of a taut line to bending.

    e = d (1 + (theta_y^2 + theta_z^2) / 24 + c_y n_y^2 + c_z n_z^2) - l,   d = |y|,   n = y / d
    c_y = a - 2 a^2 / 5 - 1/2,   a = k_y l^3 / (12 E I_z),   likewise c_z

e / l is the strain of Reissner's rod along the normal of its sections, mean over the element, to
second order in rotations: with w the lateral deflection of the line and phi the rotation of its
sections in the frame,

    e = u_x + integral of (phi w' - phi^2 / 2) dx

and phi a parabola, from -theta/2 at one end to theta/2 at the other, w' - phi the one shear of the
element. In a slender one a = 1, c = 1/10, and a tension has the whole work N / 2 times the integral
of w'^2 of the cubic line; as l goes to zero, a does, c = -1/2 and e = u_x. Consequence to test: the
stiffness at a tension N of a straight element is that of the consistent geometric stiffness, N /
(30 l) (36, 3 l, 4 l^2, ...); no tension folds an element, however long.

References: Reissner (1972), On one-dimensional finite-strain beam theory: the plane problem,
Zeitschrift für angewandte Mathematik und Physik 23, 795-804. Przemieniecki (1968), Theory of Matrix
Structural Analysis, 15.2 (geometric stiffness). Crisfield (1991), Non-linear Finite Element
Analysis of Solids and Structures, vol. 1, 7.
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, dot, scale, sub


def coefficient(shear: float, rotational: float, length: float) -> float:
    """c of the stiffness against shear [N/m] and bending [N m/rad] in one plane."""
    a = shear * length**2 / (12.0 * rotational)
    return a - 0.4 * a * a - 0.5


@kernel
def stretched(p, y, theta):
    """e, then n, d, h of the vector y between the ends, and the derivatives of e by y and theta."""
    d = sqrt(dot(y, y))
    n = scale(1.0 / d, y)
    h = (0.0, 2.0 * p.bowing[0] * n[1], 2.0 * p.bowing[1] * n[2])
    by_rotations = 1.0 + (theta[1] * theta[1] + theta[2] * theta[2]) / 24.0
    half = 0.5 * dot(h, n)
    by_displacement = add_scaled(h, by_rotations - half, n)
    by_rotation = (0.0, d / 12.0 * theta[1], d / 12.0 * theta[2])
    return d * (by_rotations + half) - p.length, (n, d, h, by_displacement, by_rotation)


@kernel
def change_of_slopes(p, theta, bent, dy, d_theta):
    """Changes of the derivatives of e by y and theta."""
    n, d, h, by_displacement, _ = bent
    along = dot(n, dy)
    dn = scale(1.0 / d, sub(dy, scale(along, n)))
    dh = (0.0, 2.0 * p.bowing[0] * dn[1], 2.0 * p.bowing[1] * dn[2])
    bends = (theta[1] * d_theta[1] + theta[2] * d_theta[2]) / 12.0
    d_by_displacement = add(scale(dot(sub(by_displacement, h), n), dn), dh)
    d_by_displacement = add_scaled(d_by_displacement, bends - dot(dh, n), n)
    d_by_rotation = (
        0.0,
        (along * theta[1] + d * d_theta[1]) / 12.0,
        (along * theta[2] + d * d_theta[2]) / 12.0,
    )
    return d_by_displacement, d_by_rotation


@kernel
def bowed(y, theta, bent):
    """Stretch by bending alone [m]."""
    _, _, h, _, by_rotation = bent
    return 0.5 * (dot(theta, by_rotation) + abs(dot(y, h)))
