"""Layers of a shell: plane stress at points through the thickness, summed to resultants.

    N = t/2 sum w sigma,   M = t^2/4 sum w zeta sigma,   strain at zeta: eps + zeta t/2 kappa

with the points zeta in -1 ... 1 and weights w of a quadrature rule. Beyond the yield stress, with
xi = sigma - alpha, the plastic strain is g P xi and

    s1 / (1 + c1 g)^2 + s2 / (1 + c2 g)^2 = Y(e + 2/3 g Y)^2
    s1 = (xi_x + xi_y)^2 / 4,   s2 = 3 (xi_x - xi_y)^2 / 4 + 3 xi_xy^2   of the trial stress
    c1 = E / (3 - 3 nu) + 2/3 H_k,   c2 = 2 G + 2/3 H_k

whose root g Newton's method finds from below. Transverse shear stays elastic.

Reference: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670.
"""

from math import sqrt

from crashsolve.foundation.compile import inlined, kernel
from crashsolve.foundation.curve import curve_near
from crashsolve.foundation.point import LANES
from crashsolve.parts._quad_block import (
    AREA,
    CURVATURE,
    DEPTH,
    LAYERS,
    LOSS,
    MEMBRANE,
    MOMENT,
    RESULTANT,
    ROWS,
    SOFT_PLANE,
    THICKNESS,
)

# rows of a plastic layer: stress, equivalent plastic strain, alpha; two more with a curve: its
# value at the strain, and the segment in which that lies
STRAIN, BACK, PLASTIC_ROWS, FLOW, SEGMENT, CURVE_ROWS = 3, 4, 7, 7, 8, 9
# further rows of `work`: trial stress less alpha, s1, s2, g, yield stress, its slope, factor of
# rate, what is missing; of all layers, strain across the thickness, plastic work, and what
# yielding leaves of the stiffness in the plane along x and y, and in bending
XI, S1, S2, G, YIELD, SLOPE, FACTOR, GAP, THIN, LOST, STIFF = (
    ROWS + k for k in (0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
)
ALL_ROWS = ROWS + 16
PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14


@kernel
def clear_resultants(work):
    """Writes: work."""
    for e in range(6 * LANES):
        work[LANES * RESULTANT + e] = 0.0
    for e in range(LANES):
        work[LANES * THIN + e] = 0.0
        work[LANES * LOST + e] = 0.0
        for k in range(4):
            work[LANES * (STIFF + k) + e] = 0.0


@inlined
def layer_strain(work, e, z):
    """Strain of the step at the height z."""
    at, to = LANES * MEMBRANE + e, LANES * CURVATURE + e
    return (
        work[at] + z * work[to],
        work[at + LANES] + z * work[to + LANES],
        work[at + 2 * LANES] + z * work[to + 2 * LANES],
    )


@inlined
def add_resultants(work, e, n, z, s):
    """Share of a layer in the resultants. Writes: work."""
    at, to = LANES * RESULTANT + e, LANES * MOMENT + e
    work[at] += n * s[0]
    work[at + LANES] += n * s[1]
    work[at + 2 * LANES] += n * s[2]
    work[to] += n * z * s[0]
    work[to + LANES] += n * z * s[1]
    work[to + 2 * LANES] += n * z * s[2]


@kernel
def elastic_layer(blocks, at, work, p, zeta, weight):
    """Stress of a layer after the strains of a step. Writes: blocks, work."""
    nu, shear = p.poisson, p.shear
    C, thin = p.young / (1.0 - nu * nu), -0.5 * weight * nu / (1.0 - nu)
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        z = 0.5 * t * zeta
        x, y, xy = layer_strain(work, e, z)
        s_x = blocks[at + e] + C * (x + nu * y)
        s_y = blocks[at + LANES + e] + C * (y + nu * x)
        s_xy = blocks[at + 2 * LANES + e] + shear * xy
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = s_x, s_y, s_xy
        add_resultants(work, e, 0.5 * t * weight, z, (s_x, s_y, s_xy))
        work[LANES * THIN + e] += thin * (x + y)


@kernel
def layers(blocks, first, work, h, p, curves):
    """Stresses of all layers of a block after a step of h, their resultants, the thickness.

    Writes: blocks, work.
    """
    clear_resultants(work)
    for k in range(p.layers):
        at = first + LANES * (LAYERS + p.layer_rows * k)
        # a step of no length changes nothing, whatever the rate was
        if p.plastic == 0 or h == 0.0:
            elastic_layer(blocks, at, work, p, p.zeta[k], p.weight[k])
        else:
            plastic_layer(blocks, at, work, h, p, p.zeta[k], p.weight[k], curves)
    if p.plastic == 1 and h > 0.0:
        for e in range(LANES):
            blocks[first + LANES * LOSS + e] += work[LANES * LOST + e]
            for k in range(4):
                blocks[first + LANES * (SOFT_PLANE + k) + e] = work[LANES * (STIFF + k) + e]
    if p.thins == 1:
        for e in range(LANES):
            blocks[first + LANES * THICKNESS + e] *= 1.0 + work[LANES * THIN + e]


@kernel
def plastic_layer(blocks, at, work, h, p, zeta, weight, curves):
    """Stress of a plastic layer after the strains of a step of h. Writes: blocks, work."""
    if p.rate_D > 0.0:
        find_factors(work, h, p, zeta)
    find_trial(blocks, at, work, p, zeta)
    if worst_gap(work) > 0.0:
        return_to_yield(blocks, at, work, p, curves)
    settle(blocks, at, work, p, zeta, weight)


@kernel
def find_factors(work, h, p, zeta):
    """Factor of Cowper and Symonds on the yield stress, by the rate of strain. Writes: work."""
    for e in range(LANES):
        x, y, xy = layer_strain(work, e, 0.5 * work[LANES * DEPTH + e] * zeta)
        rate = sqrt(4.0 / 3.0 * (x * x + y * y + x * y + 0.25 * xy * xy)) / h
        work[LANES * FACTOR + e] = 1.0 + (rate / p.rate_D) ** (1.0 / p.rate_q)


@kernel
def find_trial(blocks, at, work, p, zeta):
    """Trial stress less alpha, and by how much it is beyond yield. Writes: work."""
    nu, shear, has_rate, has_curve = p.poisson, p.shear, p.rate_D > 0.0, p.curve > 0
    C, start, slope = p.young / (1.0 - nu * nu), p.yield_stress, p.isotropic
    for e in range(LANES):
        x, y, xy = layer_strain(work, e, 0.5 * work[LANES * DEPTH + e] * zeta)
        s_x = blocks[at + e] + C * (x + nu * y) - blocks[at + BACK * LANES + e]
        s_y = blocks[at + LANES + e] + C * (y + nu * x) - blocks[at + (BACK + 1) * LANES + e]
        s_xy = blocks[at + 2 * LANES + e] + shear * xy - blocks[at + (BACK + 2) * LANES + e]
        factor = work[LANES * FACTOR + e] if has_rate else 1.0
        flow = start + slope * blocks[at + STRAIN * LANES + e]
        flow = factor * (blocks[at + FLOW * LANES + e] if has_curve else flow)
        s1 = 0.25 * (s_x + s_y) * (s_x + s_y)
        s2 = 0.75 * (s_x - s_y) * (s_x - s_y) + 3.0 * s_xy * s_xy
        put = LANES * XI + e
        work[put], work[put + LANES], work[put + 2 * LANES] = s_x, s_y, s_xy
        work[LANES * FACTOR + e], work[LANES * SLOPE + e] = factor, factor * slope
        work[LANES * YIELD + e] = flow
        work[LANES * S1 + e], work[LANES * S2 + e], work[LANES * G + e] = s1, s2, 0.0
        work[LANES * GAP + e] = sqrt(s1 + s2) / flow - 1.0


@kernel
def look_up(blocks, at, work, p, curves):
    """Yield stress of a curve and its slope, at the present plastic strain of what yields.

    Writes: work, blocks.
    """
    c1, c2 = softening(p)
    for e in range(LANES):
        if work[LANES * G + e] == 0.0 and work[LANES * GAP + e] <= 0.0:
            continue
        g, factor = work[LANES * G + e], work[LANES * FACTOR + e]
        k1, k2 = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g)
        size = sqrt(work[LANES * S1 + e] * k1 * k1 + work[LANES * S2 + e] * k2 * k2)
        strain = blocks[at + STRAIN * LANES + e] + 2.0 / 3.0 * g * size
        place = at + SEGMENT * LANES + e
        flow, slope, found = curve_near(curves, p.curve, int(blocks[place]), strain)
        blocks[at + FLOW * LANES + e], blocks[place] = flow, float(found)
        work[LANES * YIELD + e], work[LANES * SLOPE + e] = factor * flow, factor * slope


@kernel
def worst_gap(work):
    """Largest stress beyond yield, over the yield stress."""
    worst = -1.0
    for e in range(LANES):
        worst = max(worst, work[LANES * GAP + e])
    return worst


@inlined
def softening(p):
    """c1 and c2 of the return."""
    moves = 2.0 / 3.0 * p.kinematic
    return p.young / (3.0 - 3.0 * p.poisson) + moves, 2.0 * p.shear + moves


@kernel
def return_to_yield(blocks, at, work, p, curves):
    """Newton's method for g in all lanes; those within yield stay at 0. Writes: work."""
    before = 1e300
    for _ in range(PASSES):
        if p.curve > 0:
            look_up(blocks, at, work, p, curves)
        correct(blocks, at, work, p)
        worst = worst_gap(work)
        # as good as round-off lets it be
        if worst <= CLOSE or (worst < 1e-10 and worst >= before):
            break
        before = worst


@kernel
def correct(blocks, at, work, p):
    """A step of Newton's method; the gap is that before it, of lanes that yield. Writes: work."""
    c1, c2 = softening(p)
    start, hardening, has_curve = p.yield_stress, p.isotropic, p.curve > 0
    for e in range(LANES):
        g, s1, s2 = work[LANES * G + e], work[LANES * S1 + e], work[LANES * S2 + e]
        # both factors by one division
        k = 1.0 / ((1.0 + c1 * g) * (1.0 + c2 * g))
        k1, k2 = k * (1.0 + c2 * g), k * (1.0 + c1 * g)
        a, b = s1 * k1 * k1, s2 * k2 * k2
        size = sqrt(a + b) + 1e-300
        over = 1.0 / size
        strain = blocks[at + STRAIN * LANES + e] + 2.0 / 3.0 * g * size
        flow = work[LANES * FACTOR + e] * (start + hardening * strain)
        flow = work[LANES * YIELD + e] if has_curve else flow
        fall = (a * c1 * k1 + b * c2 * k2) * over
        gap = size - flow
        steep = fall + work[LANES * SLOPE + e] * 2.0 / 3.0 * (size - g * fall)
        # a lane within yield stays there
        ahead = max(0.0, g + gap / steep)
        work[LANES * G + e] = ahead
        work[LANES * GAP + e] = abs(gap) * over if ahead > 0.0 else 0.0


@kernel
def settle(blocks, at, work, p, zeta, weight):
    """Stress, plastic strain and alpha from g; resultants, plastic work, thinning.

    Writes: blocks, work.
    """
    c1, c2 = softening(p)
    moves, softness = 2.0 / 3.0 * p.kinematic, -p.poisson / p.young
    for e in range(LANES):
        g, t = work[LANES * G + e], work[LANES * DEPTH + e]
        k1, k2 = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g)
        x, y = work[LANES * XI + e], work[LANES * (XI + 1) + e]
        both, apart = k1 * (x + y), k2 * (x - y)
        x, y, xy = 0.5 * (both + apart), 0.5 * (both - apart), k2 * work[LANES * (XI + 2) + e]
        back = at + BACK * LANES + e
        a_x = blocks[back] + g * moves * x
        a_y = blocks[back + LANES] + g * moves * y
        a_xy = blocks[back + 2 * LANES] + g * moves * xy
        blocks[back], blocks[back + LANES], blocks[back + 2 * LANES] = a_x, a_y, a_xy
        old_x, old_y, old_xy = blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e]
        # plastic strain g P xi, and the work of the mean stress on it
        size = sqrt(0.25 * both * both + 0.75 * apart * apart + 3.0 * xy * xy)
        blocks[at + STRAIN * LANES + e] += 2.0 / 3.0 * g * size
        p_x, p_y = g * (both / 6.0 + 0.5 * apart), g * (both / 6.0 - 0.5 * apart)
        s_x, s_y, s_xy = x + a_x, y + a_y, xy + a_xy
        lost = 0.5 * ((old_x + s_x) * p_x + (old_y + s_y) * p_y) + (old_xy + s_xy) * g * xy
        share, z = 0.5 * weight * t, 0.5 * t * zeta
        work[LANES * LOST + e] += share * work[LANES * AREA + e] * lost
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = s_x, s_y, s_xy
        add_resultants(work, e, share, z, (s_x, s_y, s_xy))
        # tangent over elastic modulus of stress along x alone, and along y
        tangent = work[LANES * SLOPE + e] + p.kinematic if g > 0.0 else 1.0
        flows = p.young / (size * size + 1e-300) if g > 0.0 else 0.0
        m_x, m_y = x - 0.5 * y, y - 0.5 * x
        left_x = tangent / (tangent + flows * m_x * m_x)
        left_y = tangent / (tangent + flows * m_y * m_y)
        work[LANES * STIFF + e] += 0.5 * weight * left_x
        work[LANES * (STIFF + 1) + e] += 0.5 * weight * left_y
        work[LANES * (STIFF + 2) + e] += 1.5 * weight * zeta * zeta * left_x
        work[LANES * (STIFF + 3) + e] += 1.5 * weight * zeta * zeta * left_y
        thinner = softness * (s_x + s_y - old_x - old_y) - p_x - p_y
        work[LANES * THIN + e] += 0.5 * weight * thinner
