"""Fibres of a section: uniaxial plasticity at places of it, summed to tension and moments.

    eps = eps_0 + z kappa_y - y kappa_z,   |sigma - beta H eps_p| <= Y(e) (1 + (rate / D)^(1/q))
    N = sum sigma A,   M_y = sum sigma z A,   M_z = -sum sigma y A

Beyond yield, with xi the trial stress less beta H eps_p, the plastic strain grows by g in the
direction of xi, where |xi| - (E + beta H) g = Y(e + g) (1 + ...); Newton's method finds g, in one
step where hardening is linear. Plastic work of a step is the mean stress times the plastic strain,
as nodes feel the mean of the forces before and after it. The algorithmic tangent of a fibre that
flows in a step is that of this very equation,

    d sigma = (E - E^2 / D) d eps + (E / D) Y d(...) sign(xi),   D = E + beta H + Y' (1 + ...)

Consequence to test: a fibre pulled beyond yield follows the slope E H / (E + H), and yields
backwards after 2 Y_0 where beta is 1; moduli are the derivatives of resultants.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.4 to 1.6.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.compile import inlined, kernel
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.vec3 import add_scaled, dot

MOST_FIBRES = 64
PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
ROUND_OFF = 1e-12
NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def fit(table: np.ndarray, section: dict[str, Any]) -> np.ndarray:
    """Fibres (y, z, A) moved a little and resized, to have area and second moments of a section."""
    y, z, A = table.T
    A = A * section["area"] / A.sum()
    I_y, I_z = section["second"]
    return np.array([y * np.sqrt(I_z / ((y * y) @ A)), z * np.sqrt(I_y / ((z * z) @ A)), A])


@kernel
def resultants(p, old, new, h, curves, strain, rate):
    """Tension and moments about y and z, elastic energy and plastic work per length.

    `strain` and `rate` are eps_0, kappa_y, kappa_z and their rates. Writes: new.
    """
    N, M_y, M_z, stored, lost = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(p.count):
        y, z, A = p.y[i], p.z[i], p.area[i]
        eps = strain[0] + z * strain[1] - y * strain[2]
        fast = abs(rate[0] + z * rate[1] - y * rate[2])
        xi = p.young * (eps - old.plastic[i]) - p.kinematic * old.plastic[i]
        g = growth(p, abs(xi), old.hardening[i], fast, curves) if h > 0.0 else 0.0
        step = g if xi > 0.0 else -g
        new.plastic[i], new.hardening[i] = old.plastic[i] + step, old.hardening[i] + g
        sigma = p.young * (eps - new.plastic[i])
        new.stress[i] = sigma
        stored += 0.5 * sigma * sigma / p.young * A
        lost += 0.5 * (old.stress[i] + sigma) * step * A
        N, M_y, M_z = N + sigma * A, M_y + sigma * z * A, M_z - sigma * y * A
    return N, M_y, M_z, stored, lost


@kernel
def growth(p, size, hardening, rate, curves):
    """Plastic strain of a step in which the trial stress has this size."""
    factor, g = factor_of(p, rate), 0.0
    for _ in range(PASSES):
        flow, slope = flow_of(p, hardening + g, curves)
        gap = size - (p.young + p.kinematic) * g - factor * flow
        if gap <= CLOSE * factor * flow and (g == 0.0 or gap >= -CLOSE * factor * flow):
            break
        g = max(0.0, g + gap / (p.young + p.kinematic + factor * slope))
    return g


@inlined
def factor_of(p, rate):
    """By which the yield stress is higher at a rate of strain."""
    return 1.0 + (rate / p.rate_D) ** (1.0 / p.rate_q) if p.rate_D > 0.0 else 1.0


@inlined
def flow_of(p, hardening, curves):
    """Yield stress Y at no rate, and its slope."""
    if p.curve > 0:
        flow, slope, _ = curve_value(curves, p.curve, hardening)
        return flow, slope
    return p.yield_stress + p.isotropic * hardening, p.isotropic


@kernel
def moduli(p, old, curves, strain, rate):
    """What N, M_y, M_z at the end of a step have besides E times area and second moments.

    Their values (3), and their derivatives by `strain` and by `rate` (upper halves, 6 each).
    """
    lack, by_strain, by_rate = (0.0, 0.0, 0.0), NONE, NONE
    for i in range(p.count):
        A, arm = p.area[i], (1.0, p.z[i], -p.y[i])
        speed = dot(arm, rate)
        xi = p.young * (dot(arm, strain) - old.plastic[i]) - p.kinematic * old.plastic[i]
        g = growth(p, abs(xi), old.hardening[i], abs(speed), curves)
        lack = add_scaled(lack, -p.young * A * (old.plastic[i] + (g if xi > 0.0 else -g)), arm)
        if g > 0.0:
            softer, faster = slopes(p, old.hardening[i] + g, abs(speed), curves)
            by_strain = add_square(by_strain, -A * softer, arm)
            by_rate = add_square(by_rate, A * faster if speed * xi > 0.0 else -A * faster, arm)
    return lack, by_strain, by_rate


@kernel
def slopes(p, hardening, rate, curves):
    """By how much a fibre that flows is softer than E, and how its stress grows with the rate."""
    flow, slope = flow_of(p, hardening, curves)
    factor = factor_of(p, rate)
    share = p.young / (p.young + p.kinematic + factor * slope)
    # at no rate at all the law is vertical where q is above 1, and left to the iteration
    faster = share * flow * (factor - 1.0) / (p.rate_q * rate + 1e-300)
    return p.young * share, faster


@kernel
def add_square(C, weight, arm):
    """C + weight arm arm^T of a symmetric matrix, by the rows of its upper half."""
    x, y, z = arm
    return (
        C[0] + weight * x * x,
        C[1] + weight * x * y,
        C[2] + weight * x * z,
        C[3] + weight * y * y,
        C[4] + weight * y * z,
        C[5] + weight * z * z,
    )


@kernel
def scaled(s, C):
    """A symmetric matrix times a number."""
    return (s * C[0], s * C[1], s * C[2], s * C[3], s * C[4], s * C[5])


@kernel
def squares(C):
    """A symmetric matrix as a sum of squares: L D L^T, D (3), and L_21, L_31, L_32.

    What is negative of it, as of fibres that turn back, is left out.
    """
    if not C[0] > 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    l_21, l_31 = C[1] / C[0], C[2] / C[0]
    d_2, l_32 = C[3] - l_21 * C[1], 0.0
    # fibres of one height have nothing but round-off there
    if d_2 > ROUND_OFF * C[3]:
        l_32 = (C[4] - l_31 * C[1]) / d_2
    else:
        d_2 = 0.0
    d_3 = C[5] - l_31 * C[2] - l_32 * l_32 * d_2
    return (C[0], d_2, max(d_3, 0.0)), (l_21, l_31, l_32)
