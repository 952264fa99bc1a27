"""Several walls that one probe touches on the same side of a surface: a crease, a closing fold.

    stored = 1/2 k M^2,   M = (delta_1^p + delta_2^p)^(1/p),   p = 2 / s,   of more than two those
                           that are least apart first, and their M with the others
    f_i = w_i k delta_i,   w_i = (delta_i / M)^(p - 2)
    s = c / FAR between 0 and 1,   c = (d_i - d_j n_i . n_j) / gap,   d_i <= d_j

A probe that met the nearest face alone would rattle in a crease: the force jumps from one normal to
the other with each step, and steps of finite length create energy by that. c says how
far the farther of two faces rises above the plane across the normal of the nearer, in gaps. In
flat and convex surfaces it does not rise, s = 0, and M is the depth of the nearest alone; walls of
a crease rise, and with s = 1 each has a force of its own; between, M goes smoothly from one wall to
the other. No force jumps, therefore. The forces are the gradient of the energy but for that of p,
which changes in creases below 26 degrees alone; across the middle of one the stiffness is at most
(p - 1) c / 2 < FAR of k, however flat it is. Consequence to test: between two walls a probe is in
equilibrium in the middle, with the stiffness of both.
"""

from math import sqrt

from crashsolve.contact.cells import WALLS
from crashsolve.contact.narrow._face import nearest_on_face, point_of
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import dot, put, scale, vec
from crashsolve.system.contact.projection import NO_DISTANCE, row_of, seen_from, side

# of the gap, by which the farther wall rises above the plane of the nearer: both are two
FAR = 0.1
# of that: both are one, since what is left of the crease is nothing
LEAST = 2e-3
# above any separation of two walls, from 0 to 1
FARTHEST = 2.0
# above any cosine of two normals
SAME_FACE = 4.0


@kernel
def number_of(s, w):
    """Row of what is found of the wall w on a side; those of the nearest come first."""
    return s if w == 0 else 2 + (WALLS - 1) * s + w - 1


@kernel
def look_for_walls(i, x, p, totals, sides, mesh, lists):
    """The walls beside the nearest, on both sides. Writes: sides.found."""
    for s in range(2):
        nearest = sides.found[s]
        has_normal = nearest.distance > NO_DISTANCE * p.gap
        if nearest.depth > 0.0 and nearest.crossed == 0 and has_normal:
            look_beside(i, s, x, p, totals, sides, mesh, lists)


@kernel
def look_beside(i, s, x, p, totals, sides, mesh, lists):
    """Walls beside the nearest on one side, first those with most energy. Writes: sides.found."""
    found, count = sides.found, 1
    for w in range(1, WALLS):
        if count == w and find_wall(i, s, w, x, p, totals, sides, mesh, lists):
            count += 1
    found[s].beside = count - 1
    share_out(s, count, p, found)


@kernel
def share_out(s, count, p, found):
    """Weights of the forces of all walls; those that are least apart are joined first.

    Groups of walls are as far apart as the two of their walls that are least apart.

    Writes: found.
    """
    for w in range(count):
        hit = found[number_of(s, w)]
        hit.group, hit.joined = w, hit.depth
    for _ in range(count - 1):
        least, one, two = FARTHEST, 0, 0
        for v in range(count):
            for w in range(v + 1, count):
                a, b = found[number_of(s, v)], found[number_of(s, w)]
                if a.group != b.group:
                    apart = separation_of(p, a, b)
                    if apart < least:
                        least, one, two = apart, v, w
        join(s, count, least, found[number_of(s, one)], found[number_of(s, two)], found)


@kernel
def join(s, count, apart, one, two, found):
    """Make one group of those of two walls, so far apart. Writes: found."""
    group, other = one.group, two.group
    share, share_of_other, depth = shares(one.joined, two.joined, apart)
    for w in range(count):
        hit = found[number_of(s, w)]
        if hit.group == group or hit.group == other:
            hit.weight *= share if hit.group == group else share_of_other
            hit.group, hit.joined = group, depth


@kernel
def shares(one, two, apart):
    """Weights of two depths [m] and the depth M of both [m]."""
    power = 2.0 / max(apart, LEAST)
    low, high = min(one, two), max(one, two)
    whole = high * (1.0 + (low / high) ** power) ** (1.0 / power)
    return (one / whole) ** (power - 2.0), (two / whole) ** (power - 2.0), whole


@kernel
def separation_of(p, one, two):
    """Separation of two walls, from 0 to 1."""
    return separation_between(p, one.distance, vec(one.normal), two)


@kernel
def separation_between(p, distance, n, other):
    """Separation, 0 to 1, of a wall with this distance and normal from another."""
    cosine = dot(n, vec(other.normal))
    low, high = min(distance, other.distance), max(distance, other.distance)
    return min(max((low - high * cosine) / (FAR * p.gap), 0.0), 1.0)


@kernel
def find_wall(i, s, w, x, p, totals, sides, mesh, lists):
    """Whether there is one more wall beside w others, which is kept. Writes: sides.found."""
    first, near, wait, _ = lists
    best, hit = 0.0, sides.found[number_of(s, w)]
    for k in range(first[i], first[i + 1]):
        f = near[k]
        # what waits is farther than the gap
        if mesh[5][f] == 1 or wait[k] > totals.travel or f == sides.found[s].face:
            continue
        a, b, c, d = seen_from(x, p, f, mesh)
        N, square, spot = nearest_on_face(a, b, c, d)
        distance = sqrt(square)
        if distance >= p.gap or distance <= NO_DISTANCE * p.gap:
            continue
        to = point_of(N, a, b, c, d)
        n, depth = scale(-1.0 / distance, to), p.gap - distance
        apart = separation_from(s, w, p, distance, n, sides.found)
        if apart < LEAST or apart * depth * depth <= best:
            continue
        on, crossed = side(i, p, f, spot, to, sides.states, sides.slot_in_use, mesh)
        if on == s and crossed == 0:
            best = apart * depth * depth
            keep(hit, p, f, N, distance, n)
    return best > 0.0


@kernel
def keep(hit, p, f, N, distance, n):
    """Remember a wall; its weight follows. Writes: hit."""
    hit.face, hit.distance, hit.depth, hit.crossed = f, distance, p.gap - distance, 0
    hit.weight = 1.0
    put(hit.normal, n)
    for k in range(4):
        hit.N[k] = N[k]
    if f >= p.quads:
        hit.N[2], hit.N[3] = N[2] + N[3], 0.0


@kernel
def separation_from(s, w, p, distance, n, found):
    """Separation of a wall from w others, from 0 to 1."""
    apart = 1.0
    for v in range(w):
        apart = min(apart, separation_between(p, distance, n, found[number_of(s, v)]))
    return apart


@kernel
def touching(s, found):
    """Walls that a probe touches on a side."""
    return 1 + found[s].beside if found[s].depth > 0.0 else 0


@kernel
def touched(old):
    """Walls that it has touched, of which `old` is the record of the first."""
    return 1 + old.beside if old.active == 1 else 0


@kernel
def pair_up(p, j, s, count, before, found, probe_states, slot_in_use):
    """Number of the wall touched before that each of `count` continues: the same face, or the
    nearest normal.

    Returns the sum of 2^r over the walls r that continue. Writes: found.
    """
    for w in range(count):
        found[number_of(s, w)].partner = -1
    taken = 0
    for _ in range(min(count, before)):
        best, hit_of_best, old_of_best = -2.0, 0, 0
        for w in range(count):
            hit = found[number_of(s, w)]
            if hit.partner >= 0:
                continue
            for r in range(before):
                if taken >> r & 1:
                    continue
                old = probe_states[slot_in_use[j], row_of(p, j, r)]
                alike = dot(vec(old.normal), vec(hit.normal))
                if old.face == hit.face:
                    alike += SAME_FACE
                if alike > best:
                    best, hit_of_best, old_of_best = alike, w, r
        found[number_of(s, hit_of_best)].partner = old_of_best
        taken += 1 << old_of_best
    return taken
