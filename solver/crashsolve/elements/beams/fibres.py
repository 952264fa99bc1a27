"""Fibres of a section: uniaxial plasticity at positions of it, summed to tension and moments.

    eps = eps_0 + z kappa_y - y kappa_z,   |sigma - H_k eps_p| <= Y(e) f(rate) g(T)
    N = sum sigma A,   M_y = sum sigma z A,   M_z = -sum sigma y A

The material gives its stress, or if it yields by von Mises' stress Y, f and g. Beyond yield, with
xi the trial stress less H_k eps_p, the plastic strain grows by x in the direction of xi in a step
of h, where |xi| - (E + H_k) x = Y(e + x) f(x / h) g (materials/_von_mises.py). Plastic work is the
mean stress of a step times its plastic strain: nodes receive the mean of the forces before and
after it. The algorithmic tangent of a fibre that flows in a step is that of this very equation,

    d sigma = (E - E^2 / D) d eps,   D = E + H_k + (Y' f + Y f' / h) g

As long as no fibre can have changed its strain by what it lacks to yield, N, M_y and M_z are
linear, and fibres are not evaluated one by one.

Consequence to test: a fibre pulled beyond yield follows the slope E H / (E + H), and yields
backwards after 2 Y_0 where beta is 1; moduli are the derivatives of resultants.

Reference: Simo and Hughes (1998), Computational Inelasticity, 1.4 to 1.6.
"""

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.foundation.columns import symmetric_matvec
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, put, sub, vec
from crashsolve.materials._von_mises import INFINITE, flow_rate, resistance, softening

MAX_FIBRES = 64
ROUND_OFF = 1e-12
NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SECTION = Record(f"""
    count    count                        fibres
    y        m      {MAX_FIBRES}  positions along y of the section
    z        m      {MAX_FIBRES}  positions along z of the section
    area     m^2    {MAX_FIBRES}  areas
    elastic  N, N m, N m^2  6  moduli of N, M_y, M_z without yield, upper half
    reach    m      2             largest distances along z and y
""")
# of fibres that yield by von Mises' stress
STATE = Record("""
    strain            1, 1/m     3  eps_0, kappa_y, kappa_z
    reference_strain  1, 1/m     3  the same when the fibres were last evaluated, one by one
    reference_load    N, N m     3  N, M_y, M_z then
    reference_energy  J/m           elastic energy then
    slack             1             change of strain since then up to which no fibre yields
    plastic_strain    1             largest e of the fibres
    version           count         evaluations
""")


def fit(table: np.ndarray, section: Columns) -> np.ndarray:
    """Fibres (y, z, A) corrected to the area and second moments of a section."""
    y, z, A = table.T
    A = A * section["area"] / A.sum()
    I_y, I_z = section["second"]
    return np.array([y * np.sqrt(I_z / ((y * y) @ A)), z * np.sqrt(I_y / ((z * z) @ A)), A])


def columns(table: np.ndarray, young: float) -> Columns:
    """Columns of SECTION of fitted fibres (y, z, A)."""
    room = ((0, 0), (0, MAX_FIBRES - table.shape[1]))
    y, z, A = np.pad(table, room)
    arms = np.array([np.ones_like(y), z, -y])
    return {
        "count": table.shape[1],
        "y": y,
        "z": z,
        "area": A,
        "elastic": (young * (arms * A) @ arms.T)[np.triu_indices(3)],
        "reach": (np.abs(z).max(), np.abs(y).max()),
    }


@kernel
def resultants(p, old, new, h, curves, strain, rate, material):
    """Tension and moments about y and z (3), elastic energy and plastic work per length.

    `strain` and `rate` are eps_0, kappa_y, kappa_z and their rates. Writes: new.
    """
    if material.VON_MISES:
        change = sub(strain, vec(old.reference_strain))
        across = p.reach[0] * abs(change[1]) + p.reach[1] * abs(change[2])
        if abs(change[0]) + across < old.slack:
            load, stored = elastic_section(p, old, new, strain, change, material)
            return load, stored, 0.0
        return yield_section(p, old, new, h, curves, strain, material)
    load, stored, lost = (0.0, 0.0, 0.0), 0.0, 0.0
    for i in range(p.count):
        A, arm = p.area[i], (1.0, p.z[i], -p.y[i])
        eps, fast = dot(arm, strain), dot(arm, rate)
        sigma, elastic, loss = material.fibre(p.material, old, new, i, eps, fast, h, curves)
        load = add_scaled(load, sigma * A, arm)
        stored += elastic * A
        lost += loss * A
    return load, stored, lost


@kernel
def elastic_section(p, old, new, strain, change, material):
    """Tension and moments, elastic energy per length where no fibre yields. Writes: new."""
    if new.version != old.version:
        copy_fibres(p, old, new, material)
    put(new.strain, strain)
    more, load = symmetric_matvec(p.elastic, change), vec(old.reference_load)
    stored = old.reference_energy + dot(load, change) + 0.5 * dot(more, change)
    return add(load, more), stored


@kernel
def copy_fibres(p, old, new, material):
    """Copy what changes only where some fibre may yield. Writes: new."""
    for i in range(p.count):
        new.plastic[i], new.hardening[i] = old.plastic[i], old.hardening[i]
        new.rate[i] = old.rate[i]
        if material.HEATS:
            new.temperature[i] = old.temperature[i]
    put(new.reference_strain, vec(old.reference_strain))
    put(new.reference_load, vec(old.reference_load))
    new.reference_energy, new.slack = old.reference_energy, old.slack
    new.plastic_strain, new.version = old.plastic_strain, old.version


@kernel
def yield_section(p, old, new, h, curves, strain, material):
    """Tension and moments, elastic energy, plastic work per length of fibres that yield by von
    Mises' stress. Writes: new.
    """
    load, stored, lost, slack, largest = (0.0, 0.0, 0.0), 0.0, 0.0, INFINITE, 0.0
    law, before = (p.material, curves, material), vec(old.strain)
    for i in range(p.count):
        A, arm = p.area[i], (1.0, p.z[i], -p.y[i])
        sigma, loss, free = yield_fibre(law, old, new, i, dot(arm, strain), dot(arm, before), h)
        load = add_scaled(load, sigma * A, arm)
        stored += 0.5 * sigma * sigma * A
        lost += loss * A
        slack, largest = min(slack, free), max(largest, new.hardening[i])
    stored = stored / p.material.young
    put(new.strain, strain)
    put(new.reference_strain, strain)
    put(new.reference_load, load)
    new.reference_energy, new.slack = stored, slack / p.material.young
    new.plastic_strain, new.version = largest, old.version + 1
    return load, stored, lost


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
def yield_fibre(law, old, new, i, eps, eps_before, h):
    """Stress [Pa], lost energy [J/m^3], stress up to yield [Pa], below 0 where the fibre yields.

    `law`: the material's parameters, the curves of the deck, its module. Writes: new.
    """
    m, curves, material = law
    xi, rate, _, limit = trial_state(m, old, i, eps, eps_before, h, curves, material)
    g = h * rate
    step = g if xi > 0.0 else -g
    new.plastic[i], new.hardening[i] = old.plastic[i] + step, old.hardening[i] + g
    new.rate[i] = rate if h > 0.0 else old.rate[i]
    sigma = m.young * (eps - new.plastic[i])
    lost = 0.5 * (m.young * (eps_before - old.plastic[i]) + sigma) * step
    if material.HEATS:
        new.temperature[i] = old.temperature[i] + m.heating * lost
    return sigma, lost, limit - abs(xi)


@inlined
def trial_state(m, old, i, eps, eps_before, h, curves, material):
    """Trial stress less H_k eps_p, rate of the plastic strain without sign, factor of heat, and
    the yield stress before the step. `eps_before`: strain then.
    """
    xi = m.young * (eps - old.plastic[i]) - m.kinematic * old.plastic[i]
    heat, falls = 1.0, m.young + m.kinematic
    if material.HEATS:
        heat = softening(m, old.temperature[i], material)
    e, rate = old.hardening[i], 0.0
    Y, _ = material.flow(m, e, curves)
    limit = heat * Y
    if h > 0.0 and abs(xi) > limit:
        stress = m.young * (eps_before - old.plastic[i]) - m.kinematic * old.plastic[i]
        before = (old.rate[i], abs(stress))
        rate = flow_rate(m, abs(xi), h * falls, e, limit, heat, h, before, curves, material)
    return xi, rate, heat, limit


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
            before = dot(arm, vec(old.strain))
            inelastic, reduction = flow_tangent(m, old, i, eps, before, h, curves, material)
            faster = 0.0
        else:
            inelastic, reduction, faster = material.fibre_tangent(m, old, i, eps, speed, curves)
        inelastic_part = add_scaled(inelastic_part, -m.young * A * inelastic, arm)
        by_strain = add_square(by_strain, -A * reduction, arm)
        by_rate = add_square(by_rate, A * faster, arm)
    return inelastic_part, by_strain, by_rate


@kernel
def flow_tangent(m, old, i, eps, eps_before, h, curves, material):
    """Of a fibre that yields by von Mises' stress: strain less stress / E; E less the slope of its
    stress.
    """
    xi, rate, heat, _ = trial_state(m, old, i, eps, eps_before, h, curves, material)
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
