"""Fibres of a section: uniaxial plasticity at places of it, summed to tension and moments.

    eps = eps_0 + z kappa_y - y kappa_z,   |sigma - beta H eps_p| <= Y(e) (1 + (rate / D)^(1/q))
    N = sum sigma A,   M_y = sum sigma z A,   M_z = -sum sigma y A

Beyond yield, with xi the trial stress less beta H eps_p, the plastic strain grows by g in the
direction of xi, where |xi| - (E + beta H) g = Y(e + g) (1 + ...); Newton's method finds g, in one
step where hardening is linear. Plastic work of a step is the mean stress times the plastic strain,
as nodes feel the mean of the forces before and after it. Consequence to test: a fibre pulled beyond
yield follows the slope E H / (E + H), and yields backwards after 2 Y_0 where beta is 1.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.4 to 1.6.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.curve import curve_value

MOST_FIBRES = 64
PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14


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
    factor = 1.0 + (rate / p.rate_D) ** (1.0 / p.rate_q) if p.rate_D > 0.0 else 1.0
    g = 0.0
    for _ in range(PASSES):
        flow, slope = p.yield_stress + p.isotropic * (hardening + g), p.isotropic
        if p.curve > 0:
            flow, slope, _ = curve_value(curves, p.curve, hardening + g)
        gap = size - (p.young + p.kinematic) * g - factor * flow
        if gap <= CLOSE * factor * flow and (g == 0.0 or gap >= -CLOSE * factor * flow):
            break
        g = max(0.0, g + gap / (p.young + p.kinematic + factor * slope))
    return g
