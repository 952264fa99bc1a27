"""Plastic layers of a shell: von Mises' yield condition in plane stress, for all layers at once.

With xi = sigma - alpha, the plastic strain of a layer beyond its yield stress is g P xi and

    s1 / (1 + c1 g)^2 + s2 / (1 + c2 g)^2 = Y(e + 2/3 g Y)^2
    s1 = (xi_x + xi_y)^2 / 4,   s2 = 3 (xi_x - xi_y)^2 / 4 + 3 xi_xy^2   of the trial stress,
    with the square of transverse shear and hourglass in s2 (hourglass_return.py)
    c1 = E / (3 - 3 nu) + 2/3 H_k,   c2 = 2 G + 2/3 H_k

whose root g Householder's method finds, where Y is a straight line. It works on

    Y(e) / s(g) - 1 + 2/3 H g = 0,   s^2 the left side, H the slope of the line

(return_mapping.py), which is straight in g itself if c1 = c2, and bent so little otherwise that two
steps are enough as a rule. A curve is followed from line to line. A yield stress that bends,
with a slope that may be infinite at e = 0, is followed along its tangents, the first of which is
that before the step; where e more than doubles, from a g so small that neither side of the equation
has used up half of the excess of the trial stress over yield. So is one with a factor of the rate
2/3 g s / h of the plastic strain, first along the tangent at the rate of the last step, which
follows from the stress before the step; else from the g of a stress linear in the rate. A layer
whose plastic strain has reached that of failure loses its stress in the next step, for good.

Reference: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670.
"""

from crashsolve.elements.shells.forces.corners import four, three
from crashsolve.elements.shells.records import SLOT, WORK, layer_of
from crashsolve.elements.shells.resultants import add_resultants, layer_strain, put_three
from crashsolve.elements.shells.return_mapping import (
    count_yielding,
    evaluate_trial,
    first_iteration,
    iterate,
    return_to_lines,
    return_to_tangents,
    softening,
)
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES
from crashsolve.materials._von_mises import LAYER


@blockwise
def plastic_layers(blocks, first, work, slots, h, p, span, law):
    """Stresses of plastic layers after the strains of a step of h, all those beyond yield together.

    One layer alone waits for each of its divisions and roots. `span`: the first layer, and that
    after the last. `slots` are rows of `work` as well, but none that the loops know by that name.
    Returns how many are beyond yield somewhere. Writes: blocks, work, slots.
    """
    count, (m, curves, material) = 0, law
    for k in range(span[0], span[1]):
        layer, to = layer_of(p, first, k), LANES * SLOT.SIZE * count
        if find_trial_state(blocks, layer, work, slots, to, h, law) == 0.0:
            update_elastic(blocks, layer, work, slots, to, m)
        else:
            slots[LANES * WORK.yielding + count] = k
            count += 1
    if not (material.SMOOTH or m.rated == 1) and first_iteration(slots, count, m) > 0.0:
        iterate(slots, 0, count, m)
    for slot in range(count):
        k, to = int(slots[LANES * WORK.yielding + slot]), LANES * SLOT.SIZE * slot
        layer = layer_of(p, first, k)
        at = layer.at
        if material.SMOOTH or m.rated == 1:
            return_to_tangents(blocks, at, slots, to, h, m, curves, material)
        elif m.curve > 0:
            return_to_lines(blocks, at, slots, to, m, curves, material)
        if m.kinematic > 0.0:
            shift_alpha(blocks, at, slots, to, m)
        update_plastic(blocks, layer, work, slots, to, m)
        if m.heating > 0.0:
            heat(blocks, at, slots, to, m)
    return count


@blockwise
def find_trial_state(blocks, layer, work, slots, to, h, law):
    """Find the trial stress of a layer; returns how many lanes yield. Writes: blocks, slots."""
    at, (m, curves, material) = layer.at, law
    if m.heating > 0.0:
        find_factors(blocks, layer, slots, to, m, material)
    find_trial(blocks, layer, work, slots, to, m)
    if material.SMOOTH or m.rated == 1:
        evaluate_trial(blocks, at, slots, to, m, curves, material)
        count = count_yielding(slots, to)
    else:
        count = evaluate_lines(blocks, at, slots, to, m)
    if m.failure > 0.0:
        drop_failed(blocks, layer, work, slots, to, m)
        count = count_yielding(slots, to)
    return count


@blockwise
def find_factors(blocks, layer, slots, to, m, material):
    """Factor of the temperature before the step on the yield stress. Writes: slots."""
    hot = layer.at + LANES * m.temperature_row
    for e in range(LANES):
        slots[to + LANES * SLOT.factor + e] = material.heat_factor(m, blocks[hot + e])


@blockwise
def heat(blocks, at, slots, to, m):
    """Raise the temperature of the layer by the plastic work of the step. Writes: blocks."""
    hot = at + LANES * m.temperature_row
    for e in range(LANES):
        blocks[hot + e] += m.heating * slots[to + LANES * SLOT.lost + e]


@blockwise
def drop_failed(blocks, layer, work, slots, to, m):
    """Set the stress of failed layers to zero, and add its energy. Writes: blocks, work."""
    at, _, weight = layer
    for e in range(LANES):
        has_failed = blocks[at + LAYER.plastic_strain * LANES + e] >= m.failure
        x, y, s = three(blocks, at + e)
        energy = x * x + y * y - 2.0 * m.poisson * x * y + 2.0 * (1.0 + m.poisson) * s * s
        volume = 0.5 * weight * work[LANES * WORK.depth + e] * work[LANES * WORK.area + e]
        keep = 0.0 if has_failed else 1.0
        work[LANES * WORK.dropped + e] += (1.0 - keep) * volume * energy / (2.0 * m.young)
        for row in range(3):
            blocks[at + row * LANES + e] *= keep
            slots[to + (SLOT.trial + row) * LANES + e] *= keep
            if m.kinematic > 0.0:
                blocks[at + (LAYER.alpha + row) * LANES + e] *= keep
        # transverse shear and hourglass stay with the layers that are left
        slots[to + LANES * SLOT.s1 + e] *= keep
        slots[to + LANES * SLOT.s2 + e] *= keep
        slots[to + LANES * SLOT.residual + e] = (
            -1.0 if has_failed else slots[to + LANES * SLOT.residual + e]
        )


@blockwise
def find_trial(blocks, layer, work, slots, to, m):
    """Find xi, the trial stress less alpha, with s1 and s2; g is 0. Writes: slots."""
    at, zeta, _ = layer
    nu, shear, moves = m.poisson, m.shear, m.kinematic > 0.0
    C, back = m.plane, at + LANES * LAYER.alpha
    for e in range(LANES):
        x, y, xy = layer_strain(work, e, 0.5 * work[LANES * WORK.depth + e] * zeta)
        s_x = blocks[at + e] + C * (x + nu * y)
        s_y = blocks[at + LANES + e] + C * (y + nu * x)
        s_xy = blocks[at + 2 * LANES + e] + shear * xy
        if moves:
            s_x -= blocks[back + e]
            s_y -= blocks[back + LANES + e]
            s_xy -= blocks[back + 2 * LANES + e]
        both, apart = s_x + s_y, s_x - s_y
        s2 = 0.75 * apart * apart + 3.0 * s_xy * s_xy + transverse_square(work, e, zeta)
        put_three(slots, to + LANES * SLOT.trial + e, (s_x, s_y, s_xy))
        put_three(slots, to + LANES * SLOT.s1 + e, (0.25 * both * both, s2, 0.0))


@inlined
def transverse_square(work, e, zeta):
    """Square of the trial stresses of transverse shear and hourglass at the height of a layer."""
    a_x, a_y = modes_at(work, e, zeta)
    square = work[LANES * WORK.shear_square + e] + work[LANES * WORK.mode_square + e] * a_x * a_x
    return square + work[LANES * (WORK.mode_square + 1) + e] * a_y * a_y


@inlined
def modes_at(work, e, zeta):
    """Trial a_x and a_y of the hourglass at a height."""
    z, at = 0.5 * work[LANES * WORK.depth + e] * zeta, LANES * WORK.amplitude + e
    return work[at] + z * work[at + 2 * LANES], work[at + LANES] + z * work[at + 3 * LANES]


@blockwise
def evaluate_lines(blocks, at, slots, to, m):
    """Yield stress, its slope, and the excess over it; number of lanes with an excess.

    Writes: slots.
    """
    start, slope, has_curve = m.yield_stress, m.isotropic, m.curve > 0
    line, count = at + LANES * m.line_row, 0.0
    for e in range(LANES):
        if has_curve:
            start, slope = blocks[line + e], blocks[line + LANES + e]
        flow = start + slope * blocks[at + LAYER.plastic_strain * LANES + e]
        gap = slots[to + LANES * SLOT.s1 + e] + slots[to + LANES * SLOT.s2 + e] - flow * flow
        put_three(slots, to + LANES * SLOT.flow + e, (flow, slope, 1.0))
        slots[to + LANES * SLOT.residual + e] = gap
        count += 1.0 if gap > 0.0 else 0.0
    return count


@blockwise
def update_elastic(blocks, layer, work, slots, to, m):
    """Set stress, resultants and thinning of layers that do not yield. Writes: blocks, work."""
    at, zeta, weight = layer
    softness, moves, back = -m.softness, m.kinematic > 0.0, at + LANES * LAYER.alpha
    for e in range(LANES):
        t = work[LANES * WORK.depth + e]
        x, y, xy = three(slots, to + LANES * SLOT.trial + e)
        if moves:
            x += blocks[back + e]
            y += blocks[back + LANES + e]
            xy += blocks[back + 2 * LANES + e]
        thinner = softness * (x + y - blocks[at + e] - blocks[at + LANES + e])
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = x, y, xy
        add_resultants(work, e, 0.5 * t * weight, 0.5 * t * zeta, (x, y, xy))
        work[LANES * WORK.thinning + e] += 0.5 * weight * thinner


@blockwise
def shift_alpha(blocks, at, slots, to, m):
    """alpha from g, in a loop of its own.

    In that of update_plastic() these stores would be masked, and take a third of its time always.

    Writes: blocks.
    """
    (c1, c2), shift, back = softening(m), 2.0 / 3.0 * m.kinematic, at + LANES * LAYER.alpha
    for e in range(LANES):
        g = slots[to + LANES * SLOT.g + e]
        k1, k2, move = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g), shift * g
        both, apart, xy = returned(three(slots, to + LANES * SLOT.trial + e), k1, k2)
        blocks[back + e] += 0.5 * move * (both + apart)
        blocks[back + LANES + e] += 0.5 * move * (both - apart)
        blocks[back + 2 * LANES + e] += move * xy


@inlined
def returned(xi, k1, k2):
    """Sum and difference of the normal parts of xi after the return, and its shear."""
    x, y, xy = xi
    return k1 * (x + y), k2 * (x - y), k2 * xy


@blockwise
def update_plastic(blocks, layer, work, slots, to, m):
    """Set stress, plastic strain, resultants, plastic work and thinning of layers from g.

    Writes: blocks, work, slots.
    """
    at, zeta, weight = layer
    (c1, c2), softness = softening(m), -m.softness
    moves, back = m.kinematic > 0.0, at + LANES * LAYER.alpha
    for e in range(LANES):
        g, flow = slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.flow + e]
        t, slope = work[LANES * WORK.depth + e], slots[to + LANES * SLOT.slope + e]
        u1, u2, u3 = 1.0 + c1 * g, 1.0 + c2 * g, 1.0 - 2.0 / 3.0 * slope * g
        # three factors by one division; the last is the yield stress at the end over that before
        k = 1.0 / (u1 * u2 * u3)
        k1, k2, size = k * u2 * u3, k * u1 * u3, k * u1 * u2 * flow
        both, apart, xy = returned(three(slots, to + LANES * SLOT.trial + e), k1, k2)
        x, y = 0.5 * (both + apart), 0.5 * (both - apart)
        s_x, s_y, s_xy = x, y, xy
        if moves:
            a_x, a_y, a_xy = three(blocks, back + e)
            s_x, s_y, s_xy = x + a_x, y + a_y, xy + a_xy
        old_x, old_y, old_xy = blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e]
        # plastic strain g P xi, and the work of the mean stress on it
        blocks[at + LAYER.plastic_strain * LANES + e] += 2.0 / 3.0 * g * size
        p_x, p_y = g * (both / 6.0 + 0.5 * apart), g * (both / 6.0 - 0.5 * apart)
        lost = 0.5 * ((old_x + s_x) * p_x + (old_y + s_y) * p_y) + (old_xy + s_xy) * g * xy
        share, z = 0.5 * weight * t, 0.5 * t * zeta
        work[LANES * WORK.lost + e] += share * lost
        slots[to + LANES * SLOT.lost + e] = lost
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = s_x, s_y, s_xy
        add_resultants(work, e, share, z, (s_x, s_y, s_xy))
        add_relaxation(work, e, 0.5 * weight * (1.0 - k2), z)
        thinner = softness * (s_x + s_y - old_x - old_y) - p_x - p_y
        work[LANES * WORK.thinning + e] += 0.5 * weight * thinner


@inlined
def add_relaxation(work, e, share, z):
    """Add the share k of a layer in the relaxation of shear and hourglass. Writes: work."""
    at = LANES * WORK.relaxed + e
    work[at] += share
    work[at + LANES] += share * z
    work[at + 2 * LANES] += share * z * z


@inlined
def relaxed_modes(work, e):
    """Relaxation of Q [N] and P [N m] of the hourglass by yielding."""
    at, to = LANES * WORK.relaxed + e, LANES * WORK.amplitude + e
    k, k_z, k_zz = three(work, at)
    q_x, q_y, p_x, p_y = four(work, to)
    return k * q_x + k_z * p_x, k * q_y + k_z * p_y, k_z * q_x + k_zz * p_x, k_z * q_y + k_zz * p_y
