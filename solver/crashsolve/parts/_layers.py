"""Layers of a shell: plane stress at points through the thickness, summed to resultants.

    N = t/2 sum w sigma,   M = t^2/4 sum w zeta sigma,   strain at zeta: eps + zeta t/2 kappa

with the points zeta in -1 ... 1 and weights w of a quadrature rule. Beyond the yield stress, with
xi = sigma - alpha, the plastic strain is g P xi and

    s1 / (1 + c1 g)^2 + s2 / (1 + c2 g)^2 = Y(e + 2/3 g Y)^2
    s1 = (xi_x + xi_y)^2 / 4,   s2 = 3 (xi_x - xi_y)^2 / 4 + 3 xi_xy^2   of the trial stress,
                                s2 with the square of what is beside it (_beside.py)
    c1 = E / (3 - 3 nu) + 2/3 H_k,   c2 = 2 G + 2/3 H_k

whose root g Householder's method finds, where Y is a straight line. It works on

    Y(e) / s(g) - 1 + 2/3 H g = 0,   s^2 the left side, H the slope of the line

which is straight in g itself if c1 = c2, and bent so little otherwise that two steps are enough as
a rule. A curve is followed from line to line. The power law of Johnson and Cook, whose slope is
endless at e = 0, is followed along its tangents from a g so small that neither side of the equation
has used up half of what the trial stress is beyond yield. A layer whose plastic strain has reached
that of failure loses its stress in the next step, for good.

Reference: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670.
"""

from math import exp, expm1, log, log1p, sqrt

from crashsolve.foundation.compile import blockwise, inlined
from crashsolve.foundation.curve import curve_line
from crashsolve.foundation.point import LANES
from crashsolve.parts._quad_block import (
    AREA,
    CURVATURE,
    DEPTH,
    LAYERS,
    LOSS,
    MEMBRANE,
    MOMENT,
    RATE,
    RESULTANT,
    ROWS,
    THICKNESS,
    four,
    three,
)

# rows of a plastic layer: stress, equivalent plastic strain
STRAIN, PLASTIC_ROWS = 3, 4
# one more where plastic work heats: the temperature, from 0 at the start to 1 at melting
HEAT = 4
# or alpha where it moves
BACK, BACK_ROWS = 4, 3
# with a curve, the last three: of its tangent at the strain the value at no strain and the slope,
# and the strain at which it ends
LINE_ROWS = 3
# further rows of `work`: of all layers, the strain across the thickness, the plastic work per
# area, the energy of those that fail; of large elastic strain, the largest growth of the stiffness
THIN, LOST, DROPPED, GROWTH = (ROWS + k for k in range(4))
# of the trial stresses beside those of layers (_beside.py): square of transverse shear; of the
# hourglass what a_x and a_y have at all heights, and by height, 1 / (t r)^2; sums over the layers
# of k, k z and k z^2; share of the shear stiffness that there is; transverse shear itself; numbers
# of the layers that yield
SHEARED, AMPLITUDE, SQUARES, TAKEN, WEAK, TRIAL, NUMBER = (
    ROWS + k for k in (4, 5, 9, 11, 14, 15, 17)
)
# and of each of these: trial stress less alpha, s1, s2, g, yield stress, its slope, factor of rate,
# what is missing
XI, S1, S2, G, YIELD, SLOPE, FACTOR, GAP = (ROWS + 18 + k for k in (0, 3, 4, 5, 6, 7, 8, 9))
MOST_LAYERS, SLOT_ROWS = 10, 10
ALL_ROWS = ROWS + 18 + MOST_LAYERS * SLOT_ROWS
# rows at the end of a block where elements may fail: energy of the stresses lost, and the kinetic
# energy of elements when they were deleted
FAILED_ROWS = 2
PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
# step of Householder's method over 1 / c2 + g whose fourth power is below round-off
NEAR = 2e-4
# rows of a hyperelastic layer: stress, C - 1 (xx, yy, xy), logarithm of the stretch across
METRIC, ACROSS, HYPER_ROWS = 3, 6, 7
# share of its strength that a molten layer keeps
MOLTEN = 1e-6


@blockwise
def clear_resultants(work):
    """Writes: work."""
    for e in range(6 * LANES):
        work[LANES * RESULTANT + e] = 0.0
    for e in range(LANES):
        work[LANES * THIN + e] = 0.0
        work[LANES * LOST + e] = 0.0
        work[LANES * DROPPED + e] = 0.0
        for k in range(3):
            work[LANES * (TAKEN + k) + e] = 0.0


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


@blockwise
def elastic_layer(blocks, at, work, p, zeta, weight):
    """Stress of a layer after the strains of a step. Writes: blocks, work."""
    nu, shear, C, thin = p.poisson, p.shear, p.plane, -0.5 * weight * p.across
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


@blockwise
def hyperelastic_layer(blocks, at, work, p, zeta, weight):
    """Stress of a neo-Hookean layer after the strains d of a step. Writes: blocks, work.

    C grows by U exp(2 d) U, U the root of C; axes turn with the material, so that b is C.
    """
    G, L = p.shear, p.volumetric
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        z, row = 0.5 * t * zeta, at + LANES * METRIC + e
        C = grown(three(blocks, row), layer_strain(work, e, z))
        x, y, s = C
        blocks[row], blocks[row + LANES], blocks[row + 2 * LANES] = x, y, s
        # ln of the change of area, without cancellation for small strain
        area = 0.5 * log1p(x + y + x * y - s * s)
        across = -area * p.poisson / (1.0 - p.poisson)
        for _ in range(6):
            gap = G * expm1(2.0 * across) + L * (area + across)
            across -= gap / (2.0 * G * exp(2.0 * across) + L)
        thick = expm1(2.0 * across)
        k = exp(-area - across)
        s_x, s_y, s_xy = G * k * (x - thick), G * k * (y - thick), G * k * s
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = s_x, s_y, s_xy
        add_resultants(work, e, 0.5 * t * weight, z, (s_x, s_y, s_xy))
        to = at + LANES * ACROSS + e
        work[LANES * THIN + e] += 0.5 * weight * (across - blocks[to])
        blocks[to] = across
        growth = 0.5 * k * (3.0 + x + y + thick)
        work[LANES * GROWTH + e] = max(work[LANES * GROWTH + e], growth)


@blockwise
def grow_rate(work):
    """Squared frequency of a stretched hyperelastic element. Writes: work."""
    for e in range(LANES):
        work[LANES * RATE + e] *= work[LANES * GROWTH + e]


@blockwise
def clear_growth(work):
    """Writes: work."""
    for e in range(LANES):
        work[LANES * GROWTH + e] = 1.0


@inlined
def grown(C, d):
    """C - 1 after strains d (xx, yy, twice xy)."""
    x, y, s = C
    a, b, c = d[0], d[1], 0.5 * d[2]
    # X = exp(2 d) - 1 to third order
    X, Y, Z = square_of(a, b, c)
    xx, yy, xy = 2.0 * (a + X), 2.0 * (b + Y), 2.0 * (c + Z)
    # root of C: U = (C + det) / sqrt(tr C + 2 det)
    det = sqrt((1.0 + x) * (1.0 + y) - s * s)
    k = 1.0 / sqrt(2.0 + x + y + 2.0 * det)
    u, v, w = k * (1.0 + x + det), k * (1.0 + y + det), k * s
    # U X U
    p, q, r, o = u * xx + w * xy, u * xy + w * yy, w * xx + v * xy, w * xy + v * yy
    return x + p * u + q * w, y + r * w + o * v, s + p * w + q * v


@inlined
def square_of(a, b, c):
    """Square of a symmetric tensor."""
    return a * a + c * c, b * b + c * c, c * (a + b)


@blockwise
def layers(blocks, first, stride, work, h, p, curves):
    """Stresses of all layers of a block after a step of h, their resultants, the thickness.

    Returns how many layers yield somewhere. Writes: blocks, work.
    """
    if p.hyper == 1:
        clear_growth(work)
    clear_resultants(work)
    count = through_thickness(blocks, first + LANES * LAYERS, work, h, p, curves)
    take_up(blocks, first, stride, work, h, p)
    return count


@blockwise
def through_thickness(blocks, first, work, h, p, curves):
    """Stresses of the layers at one point of the plane of every element, added to the resultants.

    Returns how many layers yield somewhere. Writes: blocks, work.
    """
    # a step of no length changes nothing, whatever the rate was
    if p.plastic == 1 and h != 0.0:
        return plastic_layers(blocks, first, work, work, h, p, 0, p.layers, curves)
    for k in range(p.layers):
        at = first + LANES * p.layer_rows * k
        if p.hyper == 1:
            hyperelastic_layer(blocks, at, work, p, p.zeta[k], p.weight[k])
        else:
            elastic_layer(blocks, at, work, p, p.zeta[k], p.weight[k])
    return 0


@blockwise
def take_up(blocks, first, stride, work, h, p):
    """Plastic work, failure and thickness of the elements after a step of h.

    Writes: blocks, work.
    """
    if p.plastic == 1:
        for e in range(LANES):
            blocks[first + LANES * LOSS + e] += work[LANES * AREA + e] * work[LANES * LOST + e]
    if p.failure > 0.0:
        for e in range(LANES):
            at = first + stride - FAILED_ROWS * LANES + e
            blocks[at] += work[LANES * DROPPED + e]
    if p.hyper == 1:
        for e in range(LANES):
            work[LANES * THIN + e] = expm1(work[LANES * THIN + e])
    if p.thins == 1:
        for e in range(LANES):
            blocks[first + LANES * THICKNESS + e] *= 1.0 + work[LANES * THIN + e]


@blockwise
def plastic_layers(blocks, first, work, slots, h, p, begin, end, curves):
    """Stresses of plastic layers after the strains of a step of h, all those beyond yield together.

    One layer alone waits for each of its divisions and roots. `slots` are rows of `work` as well,
    but none that the loops know by that name. Returns how many are beyond yield somewhere. Writes:
    blocks, work, slots.
    """
    count = 0
    for k in range(begin, end):
        at, to = first + LANES * p.layer_rows * k, LANES * SLOT_ROWS * count
        if try_layer(blocks, at, work, slots, to, h, p, p.zeta[k], p.weight[k]) == 0.0:
            stay(blocks, at, work, slots, to, p, p.zeta[k], p.weight[k])
        else:
            slots[LANES * NUMBER + count] = k
            count += 1
    if p.power == 0.0 and open_gaps(slots, count, p) > 0.0:
        close_gaps(slots, 0, count, p)
    for slot in range(count):
        k, to = int(slots[LANES * NUMBER + slot]), LANES * SLOT_ROWS * slot
        at = first + LANES * p.layer_rows * k
        if p.power > 0.0:
            return_to_power(blocks, at, slots, to, p)
        elif p.curve > 0:
            follow_lines(blocks, at, slots, to, p, curves)
        if p.kinematic > 0.0:
            shift_alpha(blocks, at, slots, to, p)
        settle(blocks, at, work, slots, to, p, p.zeta[k], p.weight[k])
        if p.heating > 0.0:
            heat(blocks, at, slots, to, p)
    return count


@blockwise
def try_layer(blocks, at, work, slots, to, h, p, zeta, weight):
    """Trial stress of a layer; in how many lanes it is beyond yield. Writes: blocks, slots."""
    if p.rate_D > 0.0 or p.rate_C > 0.0:
        find_factors(work, slots, to, h, p, zeta)
    if p.heating > 0.0:
        soften(blocks, at, slots, to, p)
    find_trial(blocks, at, work, slots, to, p, zeta)
    if p.power > 0.0:
        follow_power(blocks, at, slots, to, p)
        count = count_beyond(slots, to)
    else:
        count = find_lines(blocks, at, slots, to, p)
    if p.failure > 0.0:
        drop_failed(blocks, at, work, slots, to, p, weight)
        count = count_beyond(slots, to)
    return count


@blockwise
def find_factors(work, slots, to, h, p, zeta):
    """Factor of the rate of strain on the yield stress: of Cowper and Symonds, or logarithmic.

    Writes: slots.
    """
    for e in range(LANES):
        x, y, xy = layer_strain(work, e, 0.5 * work[LANES * DEPTH + e] * zeta)
        rate = sqrt(4.0 / 3.0 * (x * x + y * y + x * y + 0.25 * xy * xy)) / h
        if p.rate_D > 0.0:
            factor = 1.0 + (rate / p.rate_D) ** (1.0 / p.rate_q)
        else:
            factor = 1.0 + p.rate_C * log(max(rate / p.rate_0, 1.0))
        slots[to + LANES * FACTOR + e] = factor


@blockwise
def soften(blocks, at, slots, to, p):
    """Factor of temperature on the yield stress, beside that of rate. Writes: slots."""
    has_rate = p.rate_C > 0.0
    for e in range(LANES):
        factor = slots[to + LANES * FACTOR + e] if has_rate else 1.0
        hot = min(blocks[at + HEAT * LANES + e], 1.0) ** p.softening
        slots[to + LANES * FACTOR + e] = factor * max(1.0 - hot, MOLTEN)


@blockwise
def heat(blocks, at, slots, to, p):
    """Temperature of the layer from the plastic work of the step. Writes: blocks."""
    for e in range(LANES):
        blocks[at + HEAT * LANES + e] += p.heating * slots[to + LANES * GAP + e]


@blockwise
def drop_failed(blocks, at, work, slots, to, p, weight):
    """Stress of layers that have failed, and the energy it had. Writes: blocks, work."""
    for e in range(LANES):
        has_failed = blocks[at + STRAIN * LANES + e] >= p.failure
        x, y, s = three(blocks, at + e)
        energy = x * x + y * y - 2.0 * p.poisson * x * y + 2.0 * (1.0 + p.poisson) * s * s
        volume = 0.5 * weight * work[LANES * DEPTH + e] * work[LANES * AREA + e]
        keep = 0.0 if has_failed else 1.0
        work[LANES * DROPPED + e] += (1.0 - keep) * volume * energy / (2.0 * p.young)
        for row in range(3):
            blocks[at + row * LANES + e] *= keep
            slots[to + (XI + row) * LANES + e] *= keep
            if p.kinematic > 0.0:
                blocks[at + (BACK + row) * LANES + e] *= keep
        # what is beside the layers stays with those that are left
        slots[to + LANES * S1 + e] *= keep
        slots[to + LANES * S2 + e] *= keep
        slots[to + LANES * GAP + e] = -1.0 if has_failed else slots[to + LANES * GAP + e]


@inlined
def line_row(p):
    """Row of the line of a layer with a curve."""
    return p.layer_rows - LINE_ROWS


@inlined
def scaled(p):
    """Whether there is a factor on the yield stress."""
    return p.rate_D > 0.0 or p.rate_C > 0.0 or p.heating > 0.0


@blockwise
def find_trial(blocks, at, work, slots, to, p, zeta):
    """Trial stress of a layer less alpha, s1 and s2, and no g yet. Writes: slots."""
    nu, shear, moves = p.poisson, p.shear, p.kinematic > 0.0
    C, back = p.plane, at + LANES * BACK
    for e in range(LANES):
        x, y, xy = layer_strain(work, e, 0.5 * work[LANES * DEPTH + e] * zeta)
        s_x = blocks[at + e] + C * (x + nu * y)
        s_y = blocks[at + LANES + e] + C * (y + nu * x)
        s_xy = blocks[at + 2 * LANES + e] + shear * xy
        if moves:
            s_x -= blocks[back + e]
            s_y -= blocks[back + LANES + e]
            s_xy -= blocks[back + 2 * LANES + e]
        both, apart = s_x + s_y, s_x - s_y
        s2 = 0.75 * apart * apart + 3.0 * s_xy * s_xy + beside_at(work, e, zeta)
        put_three(slots, to + LANES * XI + e, (s_x, s_y, s_xy))
        put_three(slots, to + LANES * S1 + e, (0.25 * both * both, s2, 0.0))


@inlined
def beside_at(work, e, zeta):
    """Square of the trial stresses beside a layer."""
    a_x, a_y = modes_at(work, e, zeta)
    beside = work[LANES * SHEARED + e] + work[LANES * SQUARES + e] * a_x * a_x
    return beside + work[LANES * (SQUARES + 1) + e] * a_y * a_y


@inlined
def modes_at(work, e, zeta):
    """Trial a_x and a_y of the hourglass at a height."""
    z, at = 0.5 * work[LANES * DEPTH + e] * zeta, LANES * AMPLITUDE + e
    return work[at] + z * work[at + 2 * LANES], work[at + LANES] + z * work[at + 3 * LANES]


@inlined
def put_three(slots, at, s):
    """Writes: slots."""
    slots[at], slots[at + LANES], slots[at + 2 * LANES] = s


@blockwise
def find_lines(blocks, at, slots, to, p):
    """Yield stress, its slope, what is beyond it; in how many lanes something is. Writes: slots."""
    start, slope, has_factor, has_curve = p.yield_stress, p.isotropic, scaled(p), p.curve > 0
    line, count = at + LANES * line_row(p), 0.0
    for e in range(LANES):
        if has_curve:
            start, slope = blocks[line + e], blocks[line + LANES + e]
        factor = slots[to + LANES * FACTOR + e] if has_factor else 1.0
        flow = factor * (start + slope * blocks[at + STRAIN * LANES + e])
        gap = slots[to + LANES * S1 + e] + slots[to + LANES * S2 + e] - flow * flow
        put_three(slots, to + LANES * YIELD + e, (flow, factor * slope, factor))
        slots[to + LANES * GAP + e] = gap
        count += 1.0 if gap > 0.0 else 0.0
    return count


@blockwise
def follow_power(blocks, at, slots, to, p):
    """Tangent of a power at the present strain, and what is beyond it. Writes: slots."""
    c1, c2 = softening(p)
    has_factor = scaled(p)
    for e in range(LANES):
        factor = slots[to + LANES * FACTOR + e] if has_factor else 1.0
        grown, size = growth(slots, to, e, c1, c2)
        strain = blocks[at + STRAIN * LANES + e] + grown
        rises = p.power * strain**p.exponent
        # from below: its slope at no strain has no bound
        flow, slope = p.yield_stress + rises, p.exponent * rises / max(strain, 1e-300)
        slots[to + LANES * FACTOR + e], slots[to + LANES * SLOPE + e] = factor, factor * slope
        slots[to + LANES * YIELD + e] = factor * (flow - slope * grown)
        slots[to + LANES * GAP + e] = size / (factor * flow) - 1.0


@inlined
def growth(slots, to, e, c1, c2):
    """Plastic strain of the step for the present g, and the size of the stress."""
    g = slots[to + LANES * G + e]
    k1, k2 = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g)
    size = sqrt(slots[to + LANES * S1 + e] * k1 * k1 + slots[to + LANES * S2 + e] * k2 * k2)
    return 2.0 / 3.0 * g * size, size


@blockwise
def count_beyond(slots, to):
    """How many lanes have a gap; a sum, since the compiler does not vectorise a maximum."""
    count = 0.0
    for e in range(LANES):
        count += 1.0 if slots[to + LANES * GAP + e] > 0.0 else 0.0
    return count


@blockwise
def worst_gap(slots, to):
    """Largest of what is beyond yield."""
    worst = -1.0
    for e in range(LANES):
        worst = max(worst, slots[to + LANES * GAP + e])
    return worst


@inlined
def softening(p):
    """c1 and c2 of the return."""
    return p.falls_1, p.falls_2


@blockwise
def begin(slots, to, p):
    """A first g for the power law, below the root. Writes: slots."""
    c1, c2 = softening(p)
    for e in range(LANES):
        a, b, factor = (
            slots[to + LANES * S1 + e],
            slots[to + LANES * S2 + e],
            slots[to + LANES * FACTOR + e],
        )
        size = sqrt(a + b) + 1e-300
        # half of what is beyond yield: the stress falls at most as at first, and the power grows
        # at most as from no strain
        half = 0.5 * max(size - size / (1.0 + slots[to + LANES * GAP + e]), 0.0)
        falls = half * size / (a * c1 + b * c2 + 1e-300)
        grows = 1.5 / size * (half / (factor * p.power)) ** (1.0 / p.exponent)
        slots[to + LANES * G + e] = min(falls, grows)


@blockwise
def return_to_power(blocks, at, slots, to, p):
    """g of a layer whose yield stress is a power; of lanes within yield it is 0. Writes: slots."""
    before = 1e300
    begin(slots, to, p)
    follow_power(blocks, at, slots, to, p)
    for _ in range(PASSES):
        close_gaps(slots, to, 1, p)
        follow_power(blocks, at, slots, to, p)
        worst = worst_gap(slots, to)
        if is_closed(worst, before):
            return
        before = worst


@blockwise
def follow_lines(blocks, at, slots, to, p, curves):
    """g of a layer with a curve from that of the line it had. Writes: slots, blocks."""
    before = 1e300
    # one more for each of its lines
    for _ in range(PASSES + curves[p.curve].last - p.curve):
        if not has_passed(blocks, at, slots, to, p):
            return
        worst = renew_lines(blocks, at, slots, to, p, curves)
        if is_closed(worst, before):
            return
        before = worst
        close_gaps(slots, to, 1, p)


@inlined
def is_closed(worst, before):
    """Whether the gap is as small as round-off lets it be."""
    return worst <= CLOSE or (worst < 1e-10 and worst >= before)


@blockwise
def open_gaps(slots, count, p):
    """First step of close_gaps() from no g; how many lanes want more. Writes: slots."""
    (c1, c2), moving = softening(p), 0.0
    for slot in range(count):
        to = LANES * SLOT_ROWS * slot
        for e in range(LANES):
            s1, s2 = slots[to + LANES * S1 + e], slots[to + LANES * S2 + e]
            flow = slots[to + LANES * YIELD + e]
            rise = 2.0 / 3.0 * slots[to + LANES * SLOPE + e]
            g = max(0.0, step_at(1.0, 1.0, 1.0, s1, s2, flow, rise, c1, c2))
            slots[to + LANES * G + e] = g
            moving += 0.0 if c2 * g <= NEAR * (1.0 + c2 * g) else 1.0
    return moving


@blockwise
def close_gaps(slots, first, count, p):
    """g of layers in slots one after the other, yield stresses being lines. Writes: slots."""
    c1, c2 = softening(p)
    for _ in range(PASSES):
        moving = 0.0
        for slot in range(count):
            to = first + LANES * SLOT_ROWS * slot
            for e in range(LANES):
                g = slots[to + LANES * G + e]
                s1, s2 = slots[to + LANES * S1 + e], slots[to + LANES * S2 + e]
                flow = slots[to + LANES * YIELD + e]
                rise = 2.0 / 3.0 * slots[to + LANES * SLOPE + e]
                # a lane within yield stays there; none beyond it falls back to it
                ahead = max(0.5 * g, g + step_to_root(g, s1, s2, flow, rise, c1, c2))
                slots[to + LANES * G + e] = ahead
                is_near = c2 * abs(ahead - g) <= NEAR * (1.0 + c2 * ahead)
                moving += 0.0 if is_near else 1.0
        if moving == 0.0:
            return


@inlined
def step_to_root(g, s1, s2, flow, rise, c1, c2):
    """Step of Householder's method of fourth order to the root of flow / size - 1 + rise g."""
    return step_at(1.0 + c1 * g, 1.0 + c2 * g, 1.0 - rise * g, s1, s2, flow, rise, c1, c2)


@inlined
def step_at(u1, u2, left, s1, s2, flow, rise, c1, c2):
    """The same by 1 + c1 g, 1 + c2 g and 1 - rise g.

    With N that of Newton it is N (1 - b) / (1 - 2 b + b t): b and t from the second and third
    derivatives, multiplied out so that there is one division.
    """
    both, a, b = u1 * u2, s1 * u2 * u2, s2 * u1 * u1
    square = a + b + 1e-300
    size = sqrt(square)
    gap = left * size - flow * both
    falls = a * c1 * u2 + b * c2 * u1
    steep = flow * falls + rise * size * square
    bend = 1.5 * gap * flow * both * s1 * s2 * (c1 - c2) * (c1 - c2)
    # far from the root as Newton does
    bend = bend if 16.0 * abs(bend) < steep * steep else 0.0
    third = gap * (4.0 / 3.0 * square * (c1 * u2 + c2 * u1) - 5.0 / 3.0 * falls)
    over = both * steep * (steep * steep - 2.0 * bend) + bend * third + 1e-200
    return gap * square * both * (steep * steep - bend) / over


@blockwise
def has_passed(blocks, at, slots, to, p):
    """Whether a layer is beyond the end of its line of the yield stress."""
    count, end = 0.0, at + LANES * (line_row(p) + 2)
    for e in range(LANES):
        g, rise = slots[to + LANES * G + e], 2.0 / 3.0 * slots[to + LANES * SLOPE + e]
        left = blocks[end + e] - blocks[at + STRAIN * LANES + e]
        passed = 2.0 / 3.0 * g * slots[to + LANES * YIELD + e] - left * (1.0 - rise * g)
        count += 1.0 if passed > 0.0 and g > 0.0 else 0.0
    return count > 0.0


@blockwise
def renew_lines(blocks, at, slots, to, p, curves):
    """The next lines of layers beyond the end of theirs. Returns how far they are from yield.

    Writes: blocks, work.
    """
    worst, (c1, c2) = 0.0, softening(p)
    for e in range(LANES):
        grown, size = growth(slots, to, e, c1, c2)
        old, place = blocks[at + STRAIN * LANES + e], at + LANES * line_row(p) + e
        end = blocks[place + 2 * LANES]
        if slots[to + LANES * G + e] == 0.0 or old + grown <= end:
            continue
        x = end if end > old else old + grown
        base, rise, end = curve_line(curves, p.curve, x)
        blocks[place], blocks[place + LANES], blocks[place + 2 * LANES] = base, rise, end
        factor = slots[to + LANES * FACTOR + e]
        slots[to + LANES * YIELD + e], slots[to + LANES * SLOPE + e] = (
            factor * (base + rise * old),
            factor * rise,
        )
        worst = max(worst, abs(size / (factor * (base + rise * (old + grown))) - 1.0))
    return worst


@blockwise
def stay(blocks, at, work, slots, to, p, zeta, weight):
    """Stress, resultants and thinning of layers that do not yield. Writes: blocks, work."""
    softness, moves, back = -p.softness, p.kinematic > 0.0, at + LANES * BACK
    for e in range(LANES):
        t = work[LANES * DEPTH + e]
        x, y, xy = three(slots, to + LANES * XI + e)
        if moves:
            x += blocks[back + e]
            y += blocks[back + LANES + e]
            xy += blocks[back + 2 * LANES + e]
        thinner = softness * (x + y - blocks[at + e] - blocks[at + LANES + e])
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = x, y, xy
        add_resultants(work, e, 0.5 * t * weight, 0.5 * t * zeta, (x, y, xy))
        work[LANES * THIN + e] += 0.5 * weight * thinner


@blockwise
def shift_alpha(blocks, at, slots, to, p):
    """alpha from g, in a loop of its own.

    In that of settle() these stores would be masked, and take a third of its time in any case.

    Writes: blocks.
    """
    (c1, c2), shift, back = softening(p), 2.0 / 3.0 * p.kinematic, at + LANES * BACK
    for e in range(LANES):
        g = slots[to + LANES * G + e]
        k1, k2, move = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g), shift * g
        both, apart, xy = returned(three(slots, to + LANES * XI + e), k1, k2)
        blocks[back + e] += 0.5 * move * (both + apart)
        blocks[back + LANES + e] += 0.5 * move * (both - apart)
        blocks[back + 2 * LANES + e] += move * xy


@inlined
def returned(xi, k1, k2):
    """Sum and difference of the normal parts of xi after the return, and its shear."""
    x, y, xy = xi
    return k1 * (x + y), k2 * (x - y), k2 * xy


@blockwise
def settle(blocks, at, work, slots, to, p, zeta, weight):
    """Stress and plastic strain from g; resultants, plastic work, thinning.

    Writes: blocks, work, slots.
    """
    (c1, c2), softness = softening(p), -p.softness
    moves, back = p.kinematic > 0.0, at + LANES * BACK
    for e in range(LANES):
        g, flow = slots[to + LANES * G + e], slots[to + LANES * YIELD + e]
        t, slope = work[LANES * DEPTH + e], slots[to + LANES * SLOPE + e]
        u1, u2, u3 = 1.0 + c1 * g, 1.0 + c2 * g, 1.0 - 2.0 / 3.0 * slope * g
        # three factors by one division; the last is the yield stress at the end over that before
        k = 1.0 / (u1 * u2 * u3)
        k1, k2, size = k * u2 * u3, k * u1 * u3, k * u1 * u2 * flow
        both, apart, xy = returned(three(slots, to + LANES * XI + e), k1, k2)
        x, y = 0.5 * (both + apart), 0.5 * (both - apart)
        s_x, s_y, s_xy = x, y, xy
        if moves:
            a_x, a_y, a_xy = three(blocks, back + e)
            s_x, s_y, s_xy = x + a_x, y + a_y, xy + a_xy
        old_x, old_y, old_xy = blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e]
        # plastic strain g P xi, and the work of the mean stress on it
        blocks[at + STRAIN * LANES + e] += 2.0 / 3.0 * g * size
        p_x, p_y = g * (both / 6.0 + 0.5 * apart), g * (both / 6.0 - 0.5 * apart)
        lost = 0.5 * ((old_x + s_x) * p_x + (old_y + s_y) * p_y) + (old_xy + s_xy) * g * xy
        share, z = 0.5 * weight * t, 0.5 * t * zeta
        work[LANES * LOST + e] += share * lost
        # the gap is closed; its row is free
        slots[to + LANES * GAP + e] = lost
        blocks[at + e], blocks[at + LANES + e], blocks[at + 2 * LANES + e] = s_x, s_y, s_xy
        add_resultants(work, e, share, z, (s_x, s_y, s_xy))
        take(work, e, 0.5 * weight * (1.0 - k2), z)
        thinner = softness * (s_x + s_y - old_x - old_y) - p_x - p_y
        work[LANES * THIN + e] += 0.5 * weight * thinner


@inlined
def take(work, e, share, z):
    """Share k of a layer in what yielding takes from the stresses beside layers. Writes: work."""
    at = LANES * TAKEN + e
    work[at] += share
    work[at + LANES] += share * z
    work[at + 2 * LANES] += share * z * z


@inlined
def taken_modes(work, e):
    """What yielding takes from Q and P of the hourglass."""
    at, to = LANES * TAKEN + e, LANES * AMPLITUDE + e
    k, k_z, k_zz = three(work, at)
    q_x, q_y, p_x, p_y = four(work, to)
    return k * q_x + k_z * p_x, k * q_y + k_z * p_y, k_z * q_x + k_zz * p_x, k_z * q_y + k_zz * p_y
