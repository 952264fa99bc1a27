"""Return of trial stresses to the yield surface in plane stress, sixteen elements side by side.

    Y(e) / s(g) - 1 + 2/3 H g = 0

by Householder's method of fourth order, layers in slots one after the other; symbols are those of
plasticity.py. Consequence to test: the order of the method, and a root from any trial stress.

Reference: Simo and Taylor (1986), A return mapping algorithm for plane stress elastoplasticity,
Int. J. Num. Meth. Eng. 22, 649-670.
"""

from math import sqrt

from crashsolve.elements.shells.records import SLOT
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.materials._von_mises import LAYER, resistance

PASSES = 50
# of the yield stress: some units of round-off
CLOSE = 1e-14
# what may be left where it falls no further, by round-off of large slopes
STILL = 1e-10
# step of Householder's method over 1 / c2 + g whose fourth power is below round-off
NEAR = 2e-4


@blockwise
def follow_tangents(blocks, at, slots, to, h, m, curves, material):
    """Tangent of the yield stress at the present strain, what is beyond it. Writes: slots."""
    c1, c2 = softening(m)
    scaled, rated = m.heating > 0.0, m.rated == 1
    for e in range(LANES):
        heat = slots[to + LANES * SLOT.factor + e] if scaled else 1.0
        grown, size = growth(slots, to, e, c1, c2)
        old = blocks[at + LAYER.plastic_strain * LANES + e]
        if rated and grown > 0.0:
            flow, slope = at_rate(m, old, grown, heat, h, curves, material)
        else:
            Y, rises = material.flow(m, old + grown, curves)
            flow, slope = heat * Y, heat * rises
        slots[to + LANES * SLOT.factor + e], slots[to + LANES * SLOT.slope + e] = (heat, slope)
        slots[to + LANES * SLOT.flow + e] = flow - slope * grown
        slots[to + LANES * SLOT.gap + e] = size / flow - 1.0


@kernel
def at_rate(m, e, grown, heat, h, curves, material):
    """Yield stress after a growth of the plastic strain in a step of h, and its slope by that."""
    rate = grown / h
    factor = material.rate_factor(m, rate)
    held = resistance(m, e, rate, heat, h, factor, curves, material)
    return held[0], held[1] / h


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
def count_beyond(slots, to):
    """How many lanes have a gap; a sum, since the compiler does not vectorise a maximum."""
    count = 0.0
    for e in range(LANES):
        count += 1.0 if slots[to + LANES * SLOT.gap + e] > 0.0 else 0.0
    return count


@blockwise
def worst_gap(slots, to):
    """Largest of what is beyond yield, or was returned too far."""
    worst = -1.0
    for e in range(LANES):
        gap = slots[to + LANES * SLOT.gap + e]
        worst = max(worst, abs(gap) if slots[to + LANES * SLOT.g + e] > 0.0 else gap)
    return worst


@inlined
def softening(m):
    """c1 and c2 of the return."""
    return m.falls_1, m.falls_2


@blockwise
def begin(slots, to, h, m, material):
    """A first g where the yield stress bends, 0 within it. Writes: slots."""
    c1, c2 = softening(m)
    for e in range(LANES):
        a, b, factor = (
            slots[to + LANES * SLOT.s1 + e],
            slots[to + LANES * SLOT.s2 + e],
            slots[to + LANES * SLOT.factor + e],
        )
        size, gap = sqrt(a + b) + 1e-300, slots[to + LANES * SLOT.gap + e]
        beyond = size - size / (1.0 + gap) if gap > 0.0 else 0.0
        g = beyond * size / (a * c1 + b * c2 + 1e-300)
        if material.SMOOTH:
            # below the root: the stress falls at most as at first, and the yield stress grows at
            # most as from no strain; each takes half of what is beyond yield
            rise = material.strain_of_rise(m, 0.5 * beyond / factor)
            g = min(0.5 * g, 1.5 / size * rise)
        if m.rated == 1 and beyond > 0.0:
            slowed = 1.5 / size * h * material.rate_of(m, 1.0 + gap)
            g /= 1.0 + g / (slowed + 1e-300)
        slots[to + LANES * SLOT.g + e] = g
        slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e] = (0.0, 1e300)


@blockwise
def return_to_tangents(blocks, at, slots, to, h, m, curves, material):
    """g of a layer whose yield stress bends; of lanes within yield it is 0. Writes: slots."""
    before = 1e300
    begin(slots, to, h, m, material)
    follow_tangents(blocks, at, slots, to, h, m, curves, material)
    for _ in range(PASSES):
        note_sides(slots, to)
        close_gaps(slots, to, 1, m)
        stay_between(slots, to)
        follow_tangents(blocks, at, slots, to, h, m, curves, material)
        worst = worst_gap(slots, to)
        if is_closed(worst, before):
            return
        before = worst


@blockwise
def note_sides(slots, to):
    """On which side of the root g is. Writes: slots."""
    for e in range(LANES):
        g, gap = slots[to + LANES * SLOT.g + e], slots[to + LANES * SLOT.gap + e]
        least, most = slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e]
        slots[to + LANES * SLOT.least + e] = g if gap > 0.0 else least
        slots[to + LANES * SLOT.most + e] = most if gap > 0.0 else g


@blockwise
def stay_between(slots, to):
    """Half way between what holds the root where a tangent leads beyond, as at a corner of a law.

    Writes: slots.
    """
    for e in range(LANES):
        g, is_far = slots[to + LANES * SLOT.g + e], abs(slots[to + LANES * SLOT.gap + e]) > STILL
        least, most = slots[to + LANES * SLOT.least + e], slots[to + LANES * SLOT.most + e]
        is_beyond = is_far and (g <= least or g >= most)
        slots[to + LANES * SLOT.g + e] = 0.5 * (least + most) if is_beyond else g


@blockwise
def follow_lines(blocks, at, slots, to, m, curves, material):
    """g of a layer with a curve from that of the line it had. Writes: slots, blocks."""
    before = 1e300
    # one more for each of its lines
    for _ in range(PASSES + curves[m.curve].last - m.curve):
        if not has_passed(blocks, at, slots, to, m):
            return
        worst = renew_lines(blocks, at, slots, to, m, curves, material)
        if is_closed(worst, before):
            return
        before = worst
        close_gaps(slots, to, 1, m)


@inlined
def is_closed(worst, before):
    """Whether the gap is as small as round-off lets it be."""
    return worst <= CLOSE or (worst < STILL and worst >= before)


@blockwise
def open_gaps(slots, count, m):
    """First step of close_gaps() from no g; how many lanes want more. Writes: slots."""
    (c1, c2), moving = softening(m), 0.0
    for slot in range(count):
        to = LANES * SLOT.SIZE * slot
        for e in range(LANES):
            s1, s2 = slots[to + LANES * SLOT.s1 + e], slots[to + LANES * SLOT.s2 + e]
            flow = slots[to + LANES * SLOT.flow + e]
            rise = 2.0 / 3.0 * slots[to + LANES * SLOT.slope + e]
            g = max(0.0, step_at((1.0, 1.0, 1.0), (s1, s2), flow, rise, (c1, c2)))
            slots[to + LANES * SLOT.g + e] = g
            moving += 0.0 if c2 * g <= NEAR * (1.0 + c2 * g) else 1.0
    return moving


@blockwise
def close_gaps(slots, first, count, m):
    """g of layers in slots one after the other, yield stresses being lines. Writes: slots."""
    c1, c2 = softening(m)
    for _ in range(PASSES):
        moving = 0.0
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
                moving += 0.0 if is_near else 1.0
        if moving == 0.0:
            return


@inlined
def step_to_root(g, s1, s2, flow, rise, c1, c2):
    """Step of Householder's method of fourth order to the root of flow / size - 1 + rise g."""
    u = (1.0 + c1 * g, 1.0 + c2 * g, 1.0 - rise * g)
    return step_at(u, (s1, s2), flow, rise, (c1, c2))


@inlined
def step_at(u, s, flow, rise, c):
    """The same by u: 1 + c1 g, 1 + c2 g and 1 - rise g.

    With N that of Newton it is N (1 - b) / (1 - 2 b + b t): b and t from the second and third
    derivatives, multiplied out so that there is one division.
    """
    (u1, u2, left), (s1, s2), (c1, c2) = u, s, c
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
def has_passed(blocks, at, slots, to, m):
    """Whether a layer is beyond the end of its line of the yield stress."""
    count, end = 0.0, at + LANES * (m.line_row + 2)
    for e in range(LANES):
        g, rise = slots[to + LANES * SLOT.g + e], 2.0 / 3.0 * slots[to + LANES * SLOT.slope + e]
        left = blocks[end + e] - blocks[at + LAYER.plastic_strain * LANES + e]
        passed = 2.0 / 3.0 * g * slots[to + LANES * SLOT.flow + e] - left * (1.0 - rise * g)
        count += 1.0 if passed > 0.0 and g > 0.0 else 0.0
    return count > 0.0


@blockwise
def renew_lines(blocks, at, slots, to, m, curves, material):
    """The next lines of layers beyond the end of theirs. Returns how far they are from yield.

    Writes: blocks, work.
    """
    worst, (c1, c2) = 0.0, softening(m)
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
        worst = max(worst, abs(size / (base + rise * (old + grown)) - 1.0))
    return worst
