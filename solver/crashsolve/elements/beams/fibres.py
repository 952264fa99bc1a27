"""Fibres of a section: uniaxial plasticity at positions of it, summed to tension and moments.

    eps = eps_0 + z kappa_y - y kappa_z,   |sigma - H_k eps_p| <= Y(e) f(rate) g(T)
    N = sum sigma A,   M_y = sum sigma z A,   M_z = -sum sigma y A

The material gives its stress, or if it yields by von Mises' stress Y, f and g. Beyond yield, with
xi the trial stress less H_k eps_p, the plastic strain grows by x in the direction of xi in a step
of h, where |xi| - (E + H_k) x = Y(e + x) f(x / h) g (materials/_von_mises.py). Plastic work is the
mean stress of a step times its plastic strain: nodes receive the mean of the forces before and
after it. The algorithmic tangent of a fibre that flows in a step is that of this very equation,

    d sigma = (E - E^2 / D) d eps,   D = E + H_k + (Y' f + Y f' / h) g

Consequence to test: a fibre pulled beyond yield follows the slope E H / (E + H), and yields
backwards after 2 Y_0 where beta is 1; moduli are the derivatives of resultants.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.4 to 1.6.
"""

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.vec3 import add_scaled, dot
from crashsolve.materials._von_mises import flowed, resistance, softening

MAX_FIBRES = 64
ROUND_OFF = 1e-12
NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def fit(table: np.ndarray, section: Columns) -> np.ndarray:
    """Fibres (y, z, A) corrected to the area and second moments of a section."""
    y, z, A = table.T
    A = A * section["area"] / A.sum()
    I_y, I_z = section["second"]
    return np.array([y * np.sqrt(I_z / ((y * y) @ A)), z * np.sqrt(I_y / ((z * z) @ A)), A])


@kernel
def resultants(p, old, new, h, curves, strain, rate, material):
    """Tension and moments about y and z, elastic energy and plastic work per length.

    `strain` and `rate` are eps_0, kappa_y, kappa_z and their rates. Writes: new.
    """
    N, M_y, M_z, stored, lost = 0.0, 0.0, 0.0, 0.0, 0.0
    law = (p.material, curves, material)
    for i in range(p.count):
        y, z, A = p.y[i], p.z[i], p.area[i]
        eps = strain[0] + z * strain[1] - y * strain[2]
        fast = rate[0] + z * rate[1] - y * rate[2]
        if material.VON_MISES:
            sigma, elastic, loss = yield_fibre(law, old, new, i, eps, h)
        else:
            sigma, elastic, loss = material.fibre(p.material, old, new, i, eps, fast, h, curves)
        new.stress[i] = sigma
        stored += elastic * A
        lost += loss * A
        N, M_y, M_z = N + sigma * A, M_y + sigma * z * A, M_z - sigma * y * A
    return N, M_y, M_z, stored, lost


@kernel
def stiffening(p, old, curves, strain, rate, material):
    """Relative excess over E of the tangent modulus of the stiffest fibre; at least 0."""
    most = 0.0
    for i in range(p.count):
        y, z = p.y[i], p.z[i]
        eps = strain[0] + z * strain[1] - y * strain[2]
        fast = rate[0] + z * rate[1] - y * rate[2]
        _, reduction, _ = material.fibre_tangent(p.material, old, i, eps, fast, curves)
        most = max(most, -reduction / p.material.young)
    return most


@inlined
def yield_fibre(law, old, new, i, eps, h):
    """Stress [Pa], stored and lost energy [J/m^3] of a fibre that yields by von Mises' stress.

    `law`: the material's parameters, the curves of the deck, its module. Writes: new.
    """
    m, curves, material = law
    xi, rate, _ = trial_state(m, old, i, eps, h, curves, material)
    g = h * rate
    step = g if xi > 0.0 else -g
    new.plastic[i], new.hardening[i] = old.plastic[i] + step, old.hardening[i] + g
    new.rate[i] = rate if h > 0.0 else old.rate[i]
    sigma = m.young * (eps - new.plastic[i])
    lost = 0.5 * (old.stress[i] + sigma) * step
    if material.HEATS:
        new.temperature[i] = old.temperature[i] + m.heating * lost
    return sigma, 0.5 * sigma * sigma / m.young, lost


@inlined
def trial_state(m, old, i, eps, h, curves, material):
    """Trial stress less H_k eps_p, rate of the plastic strain without sign, factor of heat."""
    xi = m.young * (eps - old.plastic[i]) - m.kinematic * old.plastic[i]
    heat, falls = 1.0, m.young + m.kinematic
    if material.HEATS:
        heat = softening(m, old.temperature[i], material)
    before = (old.rate[i], abs(old.stress[i] - m.kinematic * old.plastic[i]))
    e = old.hardening[i]
    return xi, flowed(m, abs(xi), falls, e, heat, h, before, curves, material), heat


@kernel
def moduli(p, old, h, curves, strain, rate, material):
    """Inelastic parts of N, M_y, M_z at the end of a step, beside E times area and second moments.

    Their values (3), and their derivatives by `strain` and by `rate` (upper halves, 6 each).
    """
    m, inelastic_part, by_strain, by_rate = p.material, (0.0, 0.0, 0.0), NONE, NONE
    for i in range(p.count):
        A, arm = p.area[i], (1.0, p.z[i], -p.y[i])
        eps, speed = dot(arm, strain), dot(arm, rate)
        if material.VON_MISES:
            inelastic, reduction = flow_tangent(m, old, i, eps, h, curves, material)
            faster = 0.0
        else:
            inelastic, reduction, faster = material.fibre_tangent(m, old, i, eps, speed, curves)
        inelastic_part = add_scaled(inelastic_part, -m.young * A * inelastic, arm)
        by_strain = add_square(by_strain, -A * reduction, arm)
        by_rate = add_square(by_rate, A * faster, arm)
    return inelastic_part, by_strain, by_rate


@kernel
def flow_tangent(m, old, i, eps, h, curves, material):
    """Of a fibre that yields by von Mises' stress: strain less stress / E; E less the slope of its
    stress.
    """
    xi, rate, heat = trial_state(m, old, i, eps, h, curves, material)
    if rate == 0.0:
        return old.plastic[i], 0.0
    factor = material.rate_factor(m, rate) if m.rated == 1 else 1.0
    strength = resistance(m, old.hardening[i], rate, heat, h, factor, curves, material)
    share = m.young * h / ((m.young + m.kinematic) * h + strength[1])
    return old.plastic[i] + (h * rate if xi > 0.0 else -h * rate), m.young * share


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

    Negative terms, as of fibres that unload, are left out.
    """
    if not C[0] > 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    l_21, l_31 = C[1] / C[0], C[2] / C[0]
    d_2, l_32 = C[3] - l_21 * C[1], 0.0
    # where all fibres have one height, this is round-off
    if d_2 > ROUND_OFF * C[3]:
        l_32 = (C[4] - l_31 * C[1]) / d_2
    else:
        d_2 = 0.0
    d_3 = C[5] - l_31 * C[2] - l_32 * l_32 * d_2
    return (C[0], d_2, max(d_3, 0.0)), (l_21, l_31, l_32)
