"""Tangent of the layers of a shell: how resultants change with the strains of a step.

    d sigma = C d eps - (C n + ...) dg,   dg from the yield condition, whose root g is

and so the part of shear and hourglass that the layers relax (hourglass_return.py). The strains at a
point of the plane give

    X = (eps, kappa, amplitudes of the trial hourglass in the plane and by height, trial tau)
    (dN, dM, relaxed share of the amplitudes, of all, strain across) = P dX

the amplitudes being Q_x / (t r_x) and 12 P_x / (t^3 r_x), of the stress s_x.

P is the derivative of the return as it is computed (algorithmic, or consistent), so that Newton's
method keeps its order beyond yield. Consequence to test: it is the derivative of the resultants.

References: Simo and Taylor (1985), Consistent tangent operators for rate-independent
elastoplasticity, Computer Methods in Applied Mechanics and Engineering 48, 101-118. Simo and Taylor
(1986), A return mapping algorithm for plane stress elastoplasticity, Int. J. Num. Meth. Eng. 22.
"""

from math import sqrt

from crashsolve.elements.shells.forces.corners import three
from crashsolve.elements.shells.layers import add_layer
from crashsolve.elements.shells.plasticity import modes_at, plastic_layers, transverse_square
from crashsolve.elements.shells.records import BLOCK, SLOT, WORK, Law, layer_of
from crashsolve.elements.shells.resultants import clear_resultants, layer_strain
from crashsolve.elements.shells.return_mapping import softening
from crashsolve.elements.shells.tangents.records import (
    ACROSS_OUT,
    BASE,
    BENDING,
    MODES_IN,
    POINT_ROWS,
    SHEAR_IN,
    SIDE,
    TAKEN_OUT,
)
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES


@blockwise
def clear_tangent(base, at):
    """Writes: base."""
    for row in range(POINT_ROWS * LANES):
        base[at + row] = 0.0


@kernel
def layers_of_one_point(first, h, p, scene, material):
    """Stresses and tangent of the layers of elements with one point in their plane.

    Writes: scene.lanes, work, base.
    """
    clear_resultants(scene.work)
    layers_and_tangent(first + LANES * BLOCK.SIZE, LANES * BASE.points, h, p, scene, material)


@kernel
def layers_and_tangent(first, at, h, p, scene, material):
    """Stresses of the layers at a point of the plane, their resultants, the tangent of these.

    `first`: where its layers begin in scene.lanes; `at`: where its tangent does in scene.base.
    Writes: scene.lanes, work, base.
    """
    blocks, work, base = scene.lanes, scene.work, scene.base
    law = Law(p.material, scene.curves, material)
    clear_tangent(base, at)
    for k in range(p.layers):
        layer = layer_of(p, first, k)
        if material.VON_MISES:
            clear_flow(work)
            plastic_layers(blocks, first, work, work, h, p, (k, k + 1), law)
            add_plastic(work, base, at, layer, law.m)
        else:
            add_layer(blocks, layer, work, h, law)
            add_general(scene.lanes_before, blocks, layer, work, base, at, h, law)


@blockwise
def clear_flow(work):
    """Clear the sums of layers that yield. Writes: work."""
    for e in range(LANES):
        work[LANES * SLOT.g + e], work[LANES * SLOT.slope + e] = 0.0, 0.0
        work[LANES * SLOT.flow + e], work[LANES * SLOT.factor + e] = 1.0, 1.0


@inlined
def flow_of(work, e, q, zeta, m):
    """g, the stress of the end less alpha as (sum, difference, shear), and slopes of g.

    They are those by the strains d, the stresses q of the hourglass and tau: 0 within yield.
    """
    c1, c2 = softening(m)
    g, flow, slope = (
        work[LANES * SLOT.g + e],
        work[LANES * SLOT.flow + e],
        work[LANES * SLOT.slope + e],
    )
    x, y, xy = three(work, LANES * SLOT.trial + e)
    u1, u2, u3 = 1.0 + c1 * g, 1.0 + c2 * g, 1.0 - 2.0 / 3.0 * slope * g
    both, apart, s = (x + y) / u1, (x - y) / u2, xy / u2
    size, transverse = flow / u3, transverse_square(work, e, zeta) / (u2 * u2)
    square = size * size
    falls = 0.5 * c1 / u1 * both * both
    falls += c2 / u2 * (1.5 * apart * apart + 6.0 * s * s + 2.0 * transverse)
    falls += 4.0 / 3.0 * square * slope / u3
    over = 1.0 / falls if g > 0.0 else 0.0
    # of the trial stress: its sum and its difference
    p_1 = 0.5 * both / u1 * m.young / (1.0 - m.poisson)
    p_2, p_3 = 3.0 * apart / u2 * m.shear, 6.0 * s / u2 * m.shear
    by = (over * (p_1 + p_2), over * (p_1 - p_2), over * p_3)
    more, tau = 2.0 * over / (u2 * u2), LANES * WORK.trial_shear + e
    by_tau = (3.0 * more * work[tau], 3.0 * more * work[tau + LANES])
    return (g, u1, u2), (both, apart, s), by, (more * q[0], more * q[1]), by_tau


@inlined
def stress_slopes(g, stress, by, d, m):
    """Changes of the stress and of the strain across for changes `d` of strain and `by` of g."""
    (g, u1, u2), (both, apart, s), (c1, c2) = g, stress, softening(m)
    d_both = (m.young / (1.0 - m.poisson) * (d[0] + d[1]) - c1 * both * by) / u1
    d_apart = (2.0 * m.shear * (d[0] - d[1]) - c2 * apart * by) / u2
    d_s = (m.shear * d[2] - c2 * s * by) / u2
    moves = 2.0 / 3.0 * m.kinematic
    k = 1.0 + moves * g
    across = -m.poisson / m.young * (k * d_both + moves * by * both)
    across -= (by * both + g * d_both) / 3.0
    x = k * 0.5 * (d_both + d_apart) + moves * by * 0.5 * (both + apart)
    y = k * 0.5 * (d_both - d_apart) + moves * by * 0.5 * (both - apart)
    return x, y, k * d_s + moves * by * s, across


@inlined
def column_of(g, stress, q, by, d, dq, m):
    """Changes of stress, relaxation of hourglass and all, strain across; `by` that of g."""
    x, y, s, across = stress_slopes(g, stress, by, d, m)
    (_, c2), u2 = softening(m), g[2]
    left, relaxed = 1.0 / u2, c2 / (u2 * u2) * by
    q_x, q_y = (1.0 - left) * dq[0] + relaxed * q[0], (1.0 - left) * dq[1] + relaxed * q[1]
    return x, y, s, q_x, q_y, relaxed, across


@inlined
def add_column(base, at, column, n, t, z, changes):
    """Share n of a layer at the height z in a column of P. Writes: base."""
    at += LANES * column
    for k in range(3):
        row = at + LANES * SIDE * k
        base[row] += n * t * changes[k]
        base[row + LANES * SIDE * BENDING] += n * t * z * changes[k]
    for k in range(2):
        row = at + LANES * SIDE * (MODES_IN + k)
        base[row] += n * changes[3 + k]
        base[row + LANES * SIDE * 2] += n * z * changes[3 + k]
    base[at + LANES * SIDE * TAKEN_OUT] += n * changes[5]
    base[at + LANES * SIDE * ACROSS_OUT] += n * changes[6]


@inlined
def mode_stress(work, e, zeta):
    """Trial stresses of the hourglass along x and y at a height: roots of their mean squares."""
    (a_x, a_y), at = modes_at(work, e, zeta), LANES * WORK.mode_square + e
    return a_x * sqrt(work[at]), a_y * sqrt(work[at + LANES])


@blockwise
def add_plastic(work, base, at, layer, m):
    """Tangent of a plastic layer after its return. Writes: base."""
    zeta, n = layer.zeta, 0.5 * layer.weight
    no, still = (0.0, 0.0), (0.0, 0.0, 0.0)
    for e in range(LANES):
        t, q = work[LANES * WORK.depth + e], mode_stress(work, e, zeta)
        z = 0.5 * t * zeta
        g, stress, by, by_q, by_tau = flow_of(work, e, q, zeta, m)
        for k in range(3):
            direction = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
            changes = column_of(g, stress, q, by[k], direction, no, m)
            add_column(base, at + e, k, n, t, z, changes)
            add_column(base, at + e, BENDING + k, n * z, t, z, changes)
        for k in range(2):
            one = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0)
            changes = column_of(g, stress, q, by_q[k], still, one, m)
            add_column(base, at + e, MODES_IN + k, n, t, z, changes)
            add_column(base, at + e, MODES_IN + 2 + k, n * z, t, z, changes)
            changes = column_of(g, stress, q, by_tau[k], still, no, m)
            add_column(base, at + e, SHEAR_IN + k, n, t, z, changes)


@blockwise
def add_general(blocks_before, blocks, layer, work, base, to, h, law):
    """Tangent of a layer with a law of its own after a step. Writes: base."""
    (at, zeta, weight), (m, curves, material) = layer, law
    for e in range(LANES):
        t = work[LANES * WORK.depth + e]
        z, n = 0.5 * t * zeta, 0.5 * weight
        d = layer_strain(work, e, z)
        for k in range(3):
            direction = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
            (x, y, s), across = material.tangent(
                m, blocks_before, blocks, at + e, d, direction, h, curves
            )
            changes = (x, y, s, 0.0, 0.0, 0.0, across)
            add_column(base, to + e, k, n, t, z, changes)
            add_column(base, to + e, BENDING + k, n * z, t, z, changes)
