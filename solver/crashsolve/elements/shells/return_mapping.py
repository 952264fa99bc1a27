"""Return of trial stresses to the yield surface in plane stress, sixteen elements side by side.

    Y(e) / s(g) - 1 + 2/3 H g = 0

by Householder's method of fourth order, layers in slots one after the other; symbols are those of
plasticity.py. Consequence to test: the order of the method, and a root from any trial stress.

Reference: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670.
"""

from math import sqrt

from crashsolve.elements.shells.forces.corners import three
from crashsolve.elements.shells.records import SLOT
from crashsolve.elements.shells.resultants import put_three
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.materials._von_mises import LAYER, NEAR_BENT, resistance

ITERATIONS = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
# allowed residual where it falls no further, by round-off of large slopes
STILL = 1e-10
# step of Householder's method over 1 / c2 + g whose fourth power is below round-off
NEAR = 2e-4


@blockwise
def evaluate_trial(blocks, at, slots, to, m, curves, material):
    """Tangent of the yield stress before the step, and the excess of the trial stress over it.

    Writes: slots.
    """
    scaled = m.heating > 0.0
    for e in range(LANES):
        heat = slots[to + LANES * SLOT.factor + e] if scaled else 1.0
        Y, rises = material.flow(m, blocks[at + LAYER.plastic_strain * LANES + e], curves)
        size = sqrt(slots[to + LANES * SLOT.s1 + e] + slots[to + LANES * SLOT.s2 + e])
        put_three(slots, to + LANES * SLOT.flow + e, (heat * Y, heat * rises, heat))
        slots[to + LANES * SLOT.residual + e] = size / (heat * Y) - 1.0


@blockwise
def evaluate_tangents(blocks, at, slots, to, h, m, curves, material):
    """The same at the present strain; powers and logarithms only of lanes beyond yield.

    These are calls, one lane at a time: what vectors can do has loops of its own. Writes: slots.
    """
    c1, c2 = softening(m)
    for e in range(LANES):
        grown, size = growth(slots, to, e, c1, c2)
        slots[to + LANES * SLOT.grown + e], slots[to + LANES * SLOT.norm + e] = grown, size
    for e in range(LANES):
        grown, heat = slots[to + LANES * SLOT.grown + e], slots[to + LANES * SLOT.factor + e]
        if grown > 0.0:
            old = blocks[at + LAYER.plastic_strain * LANES + e]
            if m.rated == 1:
                flow, slope = at_rate(m, old, grown, heat, h, curves, material)
            else:
                Y, rises = material.flow(m, old + grown, curves)
                flow, slope = heat * Y, heat * rises
            slots[to + LANES * SLOT.slope + e] = slope
            slots[to + LANES * SLOT.flow + e] = flow
    for e in range(LANES):
        flow = slots[to + LANES * SLOT.flow + e]
        less = slots[to + LANES * SLOT.slope + e] * slots[to + LANES * SLOT.grown + e]
        slots[to + LANES * SLOT.residual + e] = slots[to + LANES * SLOT.norm + e] / flow - 1.0
        slots[to + LANES * SLOT.flow + e] = flow - less


@kernel
def at_rate(m, e, grown, heat, h, curves, material):
    """Yield stress after a growth of the plastic strain in a step of h, and its slope by that."""
    rate = grown / h
    factor = material.rate_factor(m, rate)
    strength = resistance(m, e, rate, heat, h, factor, curves, material)
    return strength[0], strength[1] / h


@inlined
def growth(slots, to, e, c1, c2):
    """Plastic strain of the step for the present g, and the size of the stress."""
    g = slots[to + LANES * SLOT.g + e]
    k1, k2 = 1.0 / (1.0 + c1 * g), 1.0 / (1.0 + c2 * g)
    size = sqrt(
        slots[to + LANES * SLOT.s1 + e] * k1 * k1 + slots[to + LANES * SLOT.s2 + e] * k2 * k2
    )
    return 2.0 / 3.0 * g * size, size


@blockwise
def count_yielding(slots, to):
    """Number of lanes that yield; a sum, since the compiler does not vectorise a maximum."""
    count = 0.0
    for e in range(LANES):
        count += 1.0 if slots[to + LANES * SLOT.residual + e] > 0.0 else 0.0
    return count


@blockwise
def largest_residual(slots, to):
    """Largest residual of the yield condition, of either sign."""
    largest = -1.0
    for e in range(LANES):
        gap = slots[to + LANES * SLOT.residual + e]
        largest = max(largest, abs(gap) if slots[to + LANES * SLOT.g + e] > 0.0 else gap)
    return largest


@inlined
def softening(m):
    """c1 and c2 of the return."""
    return m.falls_1, m.falls_2


@blockwise
def begin(blocks, at, slots, to, h, m, material):
    """A first g where the yield stress bends, 0 within it: along the tangent before the step.

    Writes: slots.
    """
    c, rated = softening(m), m.rated == 1
    for e in range(LANES):
        s = (slots[to + LANES * SLOT.s1 + e], slots[to + LANES * SLOT.s2 + e])
        flow, slope = slots[to + LANES * SLOT.flow + e], slots[to + LANES * SLOT.slope + e]
        g = max(0.0, step_at((1.0, 1.0, 1.0), s, flow, 2.0 / 3.0 * slope, c))
        slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.norm + e] = g, sqrt(s[0] + s[1])
        slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e] = (0.0, 1e300)
        if rated:
            slots[to + LANES * SLOT.last + e] = size_before(blocks, at + e, slots, to + e, m) / flow
    for e in range(LANES):
        g, flow = slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.flow + e]
        if g > 0.0:
            old = blocks[at + LAYER.plastic_strain * LANES + e]
            if material.SMOOTH and 2.0 / 3.0 * g * flow > old:
                g = begin_from_nothing(slots, to + e, m, material)
            if rated:
                g = begin_at_rate(m, g, slots, to + e, h, material)
            slots[to + LANES * SLOT.g + e] = g


@kernel
def begin_from_nothing(slots, to, m, material):
    """A first g of a lane whose tangent before the step bends too much, or may be upright.

    Below the root: the stress falls at most as at first, and the yield stress grows at most as
    from no strain; each takes half of the excess over yield.
    """
    c1, c2 = softening(m)
    size, s1, s2 = (
        slots[to + LANES * SLOT.norm],
        slots[to + LANES * SLOT.s1],
        slots[to + LANES * SLOT.s2],
    )
    half = 0.5 * (size - slots[to + LANES * SLOT.flow])
    rise = material.strain_of_rise(m, half / slots[to + LANES * SLOT.factor])
    return min(half * size / (s1 * c1 + s2 * c2), 1.5 / size * rise)


@kernel
def begin_at_rate(m, g, slots, to, h, material):
    """A first g of a lane whose yield stress grows with the rate, from the g of one that does not.

    Along the tangent of the rate of the last step, which follows from its stress; where this leads
    far from it, exact where nothing hardens and stress is linear in the rate.
    """
    c, s = softening(m), (slots[to + LANES * SLOT.s1], slots[to + LANES * SLOT.s2])
    flow, slope = slots[to + LANES * SLOT.flow], slots[to + LANES * SLOT.slope]
    factor = max(slots[to + LANES * SLOT.last], 1.0)
    rate = material.rate_of(m, factor)
    grown = h * rate
    if grown >= 2.0 / 3.0 * g * flow:
        return g
    if grown > 0.0:
        tangent = factor * slope + material.rate_slopes(m, rate, factor)[0] * flow / h
        level = factor * (flow + slope * grown)
        rise = 2.0 / 3.0 * tangent
        ahead = step_at((1.0, 1.0, 1.0), s, level - tangent * grown, rise, c)
        if abs(2.0 / 3.0 * ahead * level - grown) < 0.5 * grown:
            return ahead
    size = slots[to + LANES * SLOT.norm]
    slowed = 1.5 / size * h * material.rate_of(m, size / flow)
    return g / (1.0 + g / (slowed + 1e-300))


@inlined
def size_before(blocks, at, slots, to, m):
    """Size of the stress of a lane before the step; transverse shear as the deviator of its plane.

    A start need not know more: it is exact where a layer strains on as it did.
    """
    x, y, xy = three(blocks, at)
    if m.kinematic > 0.0:
        a_x, a_y, a_xy = three(blocks, at + LAYER.alpha * LANES)
        x, y, xy = x - a_x, y - a_y, xy - a_xy
    t_x, t_y, t_xy = three(slots, to + LANES * SLOT.trial)
    before = 0.75 * (x - y) * (x - y) + 3.0 * xy * xy
    trial = 0.75 * (t_x - t_y) * (t_x - t_y) + 3.0 * t_xy * t_xy
    share = before / (trial + 1e-300)
    return sqrt(0.25 * (x + y) * (x + y) + share * slots[to + LANES * SLOT.s2])


@blockwise
def return_to_tangents(blocks, at, slots, to, h, m, curves, material):
    """g of a layer whose yield stress bends; of lanes within yield it is 0.

    A correction of g by less than d = NEAR_BENT of it is not verified: the plastic strain e is at
    least that of the step, so that a power e^n is off its tangent by at most n (1 - n) / 2 d^2 <=
    d^2 / 8 of itself, a factor 1 + C ln(rate) by C / 2 d^2, less than CLOSE. Only where the last
    correction passes the rate from which C counts are they C d apart. Writes: slots.
    """
    before = 1e300
    begin(blocks, at, slots, to, h, m, material)
    for _ in range(ITERATIONS):
        evaluate_tangents(blocks, at, slots, to, h, m, curves, material)
        largest = largest_residual(slots, to)
        if has_converged(largest, before):
            return
        before = largest
        note_sides(slots, to)
        iterate(slots, to, 1, m)
        if count_far(slots, to) == 0.0:
            return
        bisect_root(slots, to)


@blockwise
def count_far(slots, to):
    """Number of lanes whose g has changed so much that their tangent may not hold."""
    count = 0.0
    for e in range(LANES):
        g, gap = slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.residual + e]
        least, most = slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e]
        count += 1.0 if abs(g - (least if gap > 0.0 else most)) > NEAR_BENT * g else 0.0
    return count


@blockwise
def note_sides(slots, to):
    """On which side of the root g is. Writes: slots."""
    for e in range(LANES):
        g, gap = slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.residual + e]
        least, most = slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e]
        slots[to + LANES * SLOT.least + e] = g if gap > 0.0 else least
        slots[to + LANES * SLOT.most + e] = most if gap > 0.0 else g


@blockwise
def bisect_root(slots, to):
    """Bisect the bracket of the root where a tangent leads out of it, as at a corner of a law.

    Writes: slots.
    """
    for e in range(LANES):
        g, is_far = (
            slots[to + LANES * SLOT.g + e],
            abs(slots[to + LANES * SLOT.residual + e]) > STILL,
        )
        least, most = slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e]
        is_beyond = is_far and (g <= least or g >= most)
        slots[to + LANES * SLOT.g + e] = 0.5 * (least + most) if is_beyond else g


@blockwise
def return_to_lines(blocks, at, slots, to, m, curves, material):
    """g of a layer with a curve from that of the line it had. Writes: slots, blocks."""
    before = 1e300
    # one more for each of its lines
    for _ in range(ITERATIONS + curves[m.curve].last - m.curve):
        if not has_passed(blocks, at, slots, to, m):
            return
        largest = next_lines(blocks, at, slots, to, m, curves, material)
        if has_converged(largest, before):
            return
        before = largest
        iterate(slots, to, 1, m)


@inlined
def has_converged(largest, before):
    """Whether the gap is as small as round-off lets it be."""
    return largest <= CLOSE or (largest < STILL and largest >= before)


@blockwise
def first_iteration(slots, count, m):
    """First step of iterate() from g = 0; returns how many lanes need more. Writes: slots."""
    (c1, c2), unconverged = softening(m), 0.0
    for slot in range(count):
        to = LANES * SLOT.SIZE * slot
        for e in range(LANES):
            s1, s2 = slots[to + LANES * SLOT.s1 + e], slots[to + LANES * SLOT.s2 + e]
            flow = slots[to + LANES * SLOT.flow + e]
            rise = 2.0 / 3.0 * slots[to + LANES * SLOT.slope + e]
            g = max(0.0, step_at((1.0, 1.0, 1.0), (s1, s2), flow, rise, (c1, c2)))
            slots[to + LANES * SLOT.g + e] = g
            unconverged += 0.0 if c2 * g <= NEAR * (1.0 + c2 * g) else 1.0
    return unconverged


@blockwise
def iterate(slots, first, count, m):
    """Find g of layers in successive slots, with linear yield stresses. Writes: slots."""
    c1, c2 = softening(m)
    for _ in range(ITERATIONS):
        unconverged = 0.0
        for slot in range(count):
            to = first + LANES * SLOT.SIZE * slot
            for e in range(LANES):
                g = slots[to + LANES * SLOT.g + e]
                s1, s2 = slots[to + LANES * SLOT.s1 + e], slots[to + LANES * SLOT.s2 + e]
                flow = slots[to + LANES * SLOT.flow + e]
                rise = 2.0 / 3.0 * slots[to + LANES * SLOT.slope + e]
                # a lane within yield stays there; none beyond it falls back to it
                ahead = max(0.5 * g, g + step_to_root(g, s1, s2, flow, rise, c1, c2))
                slots[to + LANES * SLOT.g + e] = ahead
                is_near = c2 * abs(ahead - g) <= NEAR * (1.0 + c2 * ahead)
                unconverged += 0.0 if is_near else 1.0
        if unconverged == 0.0:
            return


@inlined
def step_to_root(g, s1, s2, flow, rise, c1, c2):
    """Step of Householder's method of fourth order to the root of flow / size - 1 + rise g."""
    u = (1.0 + c1 * g, 1.0 + c2 * g, 1.0 - rise * g)
    return step_at(u, (s1, s2), flow, rise, (c1, c2))


@inlined
def step_at(u, s, flow, rise, c):
    """The step from u = (1 + c1 g, 1 + c2 g, 1 - rise g).

    With N that of Newton it is N (1 - b) / (1 - 2 b + b t): b and t from the second and third
    derivatives, multiplied out so that there is one division.
    """
    (u1, u2, left), (s1, s2), (c1, c2) = u, s, c
    both, a, b = u1 * u2, s1 * u2 * u2, s2 * u1 * u1
    square = a + b + 1e-300
    size = sqrt(square)
    residual = left * size - flow * both
    falls = a * c1 * u2 + b * c2 * u1
    steep = flow * falls + rise * size * square
    bend = 1.5 * residual * flow * both * s1 * s2 * (c1 - c2) * (c1 - c2)
    # far from the root as Newton does
    bend = bend if 16.0 * abs(bend) < steep * steep else 0.0
    third = residual * (4.0 / 3.0 * square * (c1 * u2 + c2 * u1) - 5.0 / 3.0 * falls)
    over = both * steep * (steep * steep - 2.0 * bend) + bend * third + 1e-200
    return residual * square * both * (steep * steep - bend) / over


@blockwise
def has_passed(blocks, at, slots, to, m):
    """Whether a layer is beyond the end of its line of the yield stress, in any lane."""
    count, end = 0.0, at + LANES * (m.line_row + 2)
    for e in range(LANES):
        g, rise = slots[to + LANES * SLOT.g + e], 2.0 / 3.0 * slots[to + LANES * SLOT.slope + e]
        left = blocks[end + e] - blocks[at + LAYER.plastic_strain * LANES + e]
        passed = 2.0 / 3.0 * g * slots[to + LANES * SLOT.flow + e] - left * (1.0 - rise * g)
        count += 1.0 if passed > 0.0 and g > 0.0 else 0.0
    return count > 0.0


@blockwise
def next_lines(blocks, at, slots, to, m, curves, material):
    """Set the next lines of layers beyond the end of theirs. Returns the largest residual.

    Writes: blocks, work.
    """
    largest, (c1, c2) = 0.0, softening(m)
    for e in range(LANES):
        grown, size = growth(slots, to, e, c1, c2)
        old, entry = blocks[at + LAYER.plastic_strain * LANES + e], at + LANES * m.line_row + e
        end = blocks[entry + 2 * LANES]
        if slots[to + LANES * SLOT.g + e] == 0.0 or old + grown <= end:
            continue
        x = end if end > old else old + grown
        base, rise, end = material.line(m, x, curves)
        blocks[entry], blocks[entry + LANES], blocks[entry + 2 * LANES] = base, rise, end
        slots[to + LANES * SLOT.flow + e], slots[to + LANES * SLOT.slope + e] = (
            base + rise * old,
            rise,
        )
        largest = max(largest, abs(size / (base + rise * (old + grown)) - 1.0))
    return largest
