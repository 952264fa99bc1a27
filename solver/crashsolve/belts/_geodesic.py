"""Geodesics of an ellipsoid, from a point outside of it, each with the distance to its neighbour.

    x'' = -kappa n,   kappa = x' . H x' / |H x|,   n = H x / |H x|,   H = diag(1 / a_i^2)
    j'' + K j = 0,    K = H_1 H_2 H_3 / |H x|^4,   K the curvature of Gauss

A ray leaves A along a tangent, whose point of contact P is at the angle psi of the silhouette.
Rays from A are apart by j per angle between them: j = |P - A| and j' = 1 at P. A ray is the
shortest line between its neighbours only as long as j > 0 (Jacobi).

The variable of integration is tau, dtau^2 = kappa |x' / a| ds^2. Over a rim x changes within a
small angle of the scaled sphere, |x' / a| ds, and over a face within a small angle of the normal,
kappa ds; their geometric mean resolves both. Reference: do Carmo, Differential geometry of curves
and surfaces, 4-4 and 5-5.
Consequence to test: a ray is that of an independent integration to a tight tolerance, for any
shape, and j is the difference of two rays.
"""

from math import cos, pi, sin, sqrt
from typing import NamedTuple

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import Vector, add_scaled, cross, dot, norm, scale, sub

# steps over a tau of pi on a ball, and at least; more on others, as the width of a rim in tau is
# the square root of the ratio of the axes. With them an arc is known to 1e-5 at a ratio of 20, and
# to 1e-8 on a ball
PIECES, LEAST = 48.0, 6


class Ray(NamedTuple):
    """A geodesic at one of its points."""

    x: Vector
    t: Vector  # its direction
    length: float  # from P [m]
    bend: float  # integral of kappa [rad]
    spread: float  # j [m]
    growth: float  # j'


@kernel
def divided(x, semi):
    """x over the semi-axes."""
    return (x[0] / semi[0], x[1] / semi[1], x[2] / semi[2])


@kernel
def products(a, b):
    """Products of components."""
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@kernel
def half_second_derivatives(semi):
    """H of an ellipsoid [1/m^2]."""
    return (1.0 / semi[0] ** 2, 1.0 / semi[1] ** 2, 1.0 / semi[2] ** 2)


@kernel
def pieces_of(semi, tau):
    """Steps over tau on this ellipsoid."""
    ratio = max(semi[0], semi[1], semi[2]) / min(semi[0], semi[1], semi[2])
    return LEAST + int(PIECES / pi * tau * sqrt(sqrt(ratio)))


@kernel
def tangent_ray(semi, A, a, e, f, psi):
    """The Ray at P, and the angle between rays from A over the change of psi; a = A / semi, and e
    and f are at right angles to a and to each other.
    """
    aa = dot(a, a)
    radius = sqrt(1.0 - 1.0 / aa)
    c, s = radius * cos(psi), radius * sin(psi)
    P = products(semi, add_scaled(add_scaled(scale(1.0 / aa, a), c, e), s, f))
    P_psi = products(semi, add_scaled(scale(-s, e), c, f))
    arrival = sub(P, A)
    distance = norm(arrival)
    t = scale(1.0 / distance, arrival)
    g = products(half_second_derivatives(semi), P)
    across = scale(1.0 / norm(g), cross(g, t))
    return Ray(P, t, 0.0, 0.0, distance, 1.0), dot(P_psi, across) / distance


@kernel
def rates(H, ray):
    """Derivatives of a Ray by tau."""
    g = products(H, ray.x)
    gg, size = dot(g, g), dot(ray.t, products(H, ray.t))
    kappa = size / sqrt(gg)
    s_tau = 1.0 / sqrt(kappa * sqrt(size))
    K = H[0] * H[1] * H[2] / (gg * gg)
    return Ray(
        scale(s_tau, ray.t),
        scale(-s_tau * size / gg, g),
        s_tau,
        s_tau * kappa,
        s_tau * ray.growth,
        -s_tau * K * ray.spread,
    )


@kernel
def ahead(ray, h, by):
    """A Ray after h of its derivatives."""
    return Ray(
        add_scaled(ray.x, h, by.x),
        add_scaled(ray.t, h, by.t),
        ray.length + h * by.length,
        ray.bend + h * by.bend,
        ray.spread + h * by.spread,
        ray.growth + h * by.growth,
    )


@kernel
def step(H, ray, h):
    """A Ray after h of tau, by the method of Runge and Kutta."""
    k1 = rates(H, ray)
    k2 = rates(H, ahead(ray, 0.5 * h, k1))
    k3 = rates(H, ahead(ray, 0.5 * h, k2))
    k4 = rates(H, ahead(ray, h, k3))
    ends = ahead(ahead(ray, h / 6.0, k1), h / 6.0, k4)
    return ahead(ahead(ends, h / 3.0, k2), h / 3.0, k3)


@kernel
def trace(semi, ray, tau, pieces):
    """A Ray after tau, and the least distance to its neighbour before."""
    H = half_second_derivatives(semi)
    least = ray.spread
    for _ in range(pieces):
        ray = step(H, ray, tau / pieces)
        least = min(least, ray.spread)
    return ray, least


@kernel
def middle_of(semi, ray, tau, pieces, length):
    """Point and direction of a ray of tau at half its length."""
    H, h = half_second_derivatives(semi), tau / pieces
    after = step(H, ray, h)
    for _ in range(pieces):
        if after.length >= 0.5 * length:
            break
        ray = after
        after = step(H, ray, h)
    # within a step tau over length is linear to the second order, and one step of Newton's method
    # makes that of the fourth
    part = h * (0.5 * length - ray.length) / (after.length - ray.length)
    at = step(H, ray, part)
    at = step(H, ray, part + (0.5 * length - at.length) / rates(H, at).length)
    return at.x, at.t


@kernel
def offsets(semi, ray, B):
    """Of B from the end of a ray, along its normal, across it and along it [m], with derivatives
    of the first two by tau and by the angle between rays.
    """
    H = half_second_derivatives(semi)
    g = products(H, ray.x)
    size = norm(g)
    n, t = scale(1.0 / size, g), ray.t
    b, r = cross(n, t), sub(B, ray.x)
    along, across, above = dot(r, t), dot(r, b), dot(r, n)
    H_t, H_b = products(H, t), products(H, b)
    kappa, twist, kappa_b = dot(t, H_t) / size, dot(t, H_b) / size, dot(b, H_b) / size
    s_tau, j = rates(H, ray).length, ray.spread
    by_tau = s_tau * (kappa * along + twist * across), -s_tau * twist * above
    by_angle = (
        j * (kappa_b * across + twist * along),
        -j - ray.growth * along - j * kappa_b * above,
    )
    return (above, across, along), by_tau, by_angle
