"""Fibres of a section: uniaxial plasticity at positions of it, summed to tension and moments.

    eps = eps_0 + z kappa_y - y kappa_z,   |sigma - H_k eps_p| <= Y(e) f(rate) g(T)
    N = sum sigma A,   M_y = sum sigma z A,   M_z = -sum sigma y A

The material says its stress, or if it yields by von Mises' stress Y, f and g. Beyond yield, with xi
the trial stress less H_k eps_p, the plastic strain grows by g in the direction of xi, where |xi| -
(E + H_k) g = Y(e + g) f g; Newton's method finds it, in one step where hardening is linear. Plastic
work of a step is the mean stress times the plastic strain, because nodes receive the mean of the
forces before and after it. The algorithmic tangent of a fibre that flows in a step is that of this
very equation,

    d sigma = (E - E^2 / D) d eps + (E / D) Y d(f g) sign(xi),   D = E + H_k + Y' f g

Consequence to test: a fibre pulled beyond yield follows the slope E H / (E + H), and yields
backwards after 2 Y_0 where beta is 1; moduli are the derivatives of resultants.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.4 to 1.6.
"""

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.vec3 import add_scaled, dot
from crashsolve.materials._von_mises import factor_of

MOST_FIBRES = 64
PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
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
            sigma, held, gone = flow_on(law, old, new, i, eps, fast, h)
        else:
            sigma, held, gone = material.fibre(p.material, old, new, i, eps, fast, h, curves)
        new.stress[i] = sigma
        stored += held * A
        lost += gone * A
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
        _, softer, _ = material.fibre_tangent(p.material, old, i, eps, fast, curves)
        most = max(most, -softer / p.material.young)
    return most


@inlined
def flow_on(law, old, new, i, eps, rate, h):
    """Stress [Pa], stored and lost energy [J/m^3] of a fibre that yields by von Mises' stress.

    `law`: the material's parameters, the curves of the deck, its module. Writes: new.
    """
    m, curves, material = law
    xi = m.young * (eps - old.plastic[i]) - m.kinematic * old.plastic[i]
    g = 0.0
    if h > 0.0 and may_flow(m, old, i, abs(xi), curves, material):
        factor = fibre_factor(m, old, i, abs(rate), material)
        g = growth(m, abs(xi), old.hardening[i], factor, curves, material)
    step = g if xi > 0.0 else -g
    new.plastic[i], new.hardening[i] = old.plastic[i] + step, old.hardening[i] + g
    sigma = m.young * (eps - new.plastic[i])
    lost = 0.5 * (old.stress[i] + sigma) * step
    if material.HEATS:
        new.temperature[i] = old.temperature[i] + m.heating * lost
    return sigma, 0.5 * sigma * sigma / m.young, lost


@inlined
def may_flow(m, old, i, size, curves, material):
    """Whether a fibre with a trial stress of this size may yield.

    The factor of rate costs a power or a logarithm and is at least 1; that of heat may be less.
    """
    if material.HEATS:
        return True
    Y, _ = material.flow(m, old.hardening[i], curves)
    return size > Y


@inlined
def fibre_factor(m, old, i, rate, material):
    """Factor [1] on the yield stress by strain rate and temperature."""
    temperature = old.temperature[i] if material.HEATS else 0.0
    return factor_of(m, rate, temperature, material)


@kernel
def growth(m, size, hardening, factor, curves, material):
    """Plastic strain increment [1] of a step with a trial stress of this magnitude.

    Newton's method, and halves of what holds the root where its step leaves that: the slope of a
    power is infinite at no strain.
    """
    g, least, most = 0.0, 0.0, size / (m.young + m.kinematic)
    for _ in range(PASSES):
        flow, slope = material.flow(m, hardening + g, curves)
        gap = size - (m.young + m.kinematic) * g - factor * flow
        if gap <= CLOSE * factor * flow and (g == 0.0 or gap >= -CLOSE * factor * flow):
            break
        if gap > 0.0:
            least = g
        else:
            most = g
        ahead = g + gap / (m.young + m.kinematic + factor * slope)
        g = ahead if least < ahead < most else 0.5 * (least + most)
    return g


@kernel
def moduli(p, old, curves, strain, rate, material):
    """Differences of N, M_y, M_z at the end of a step from the elastic ones.

    Their values (3), and their derivatives by `strain` and by `rate` (upper halves, 6 each).
    """
    m, lack, by_strain, by_rate = p.material, (0.0, 0.0, 0.0), NONE, NONE
    for i in range(p.count):
        A, arm = p.area[i], (1.0, p.z[i], -p.y[i])
        eps, speed = dot(arm, strain), dot(arm, rate)
        if material.VON_MISES:
            inelastic, softer, faster = flow_tangent(m, old, i, eps, speed, curves, material)
        else:
            inelastic, softer, faster = material.fibre_tangent(m, old, i, eps, speed, curves)
        lack = add_scaled(lack, -m.young * A * inelastic, arm)
        by_strain = add_square(by_strain, -A * softer, arm)
        by_rate = add_square(by_rate, A * faster, arm)
    return lack, by_strain, by_rate


@kernel
def flow_tangent(m, old, i, eps, speed, curves, material):
    """Tangent of a fibre that yields by von Mises' stress: strain less stress / E;

    E less the slope of its stress; slope by the strain rate.
    """
    xi = m.young * (eps - old.plastic[i]) - m.kinematic * old.plastic[i]
    factor = fibre_factor(m, old, i, abs(speed), material)
    g = growth(m, abs(xi), old.hardening[i], factor, curves, material)
    inelastic = old.plastic[i] + (g if xi > 0.0 else -g)
    if g == 0.0:
        return inelastic, 0.0, 0.0
    flow, slope = material.flow(m, old.hardening[i] + g, curves)
    share = m.young / (m.young + m.kinematic + factor * slope)
    faster = 0.0
    if m.rated == 1:
        # at no rate at all the law may be vertical, and is left to the iteration
        faster = share * flow * material.rate_slope(m, abs(speed), factor)
    return inelastic, m.young * share, faster if speed * xi > 0.0 else -faster


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
