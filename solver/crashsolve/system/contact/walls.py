"""Several walls that one probe touches on the same side of a surface: a crease, a closing fold.

    stored = 1/2 k M^2,   M = (delta_1^p + delta_2^p)^(1/p),   p = 2 / s;   more than two are
                           joined in the order of their separation, by their M
    f_i = w_i k delta_i,   w_i = (delta_i / M)^(p - 2)
    s = c / FAR between 0 and 1,   c = (d_i - d_j n_i . n_j) / gap,   d_i <= d_j
                                   c = 1 - n_i . n_j of a ball on a body, with the normals of
                                       the faces at the start, and 0 where they were convex

With the nearest face alone, a probe would chatter in a crease: the force jumps from one normal to
the other with each step, and steps of finite length create energy by that. c states how
far the farther of two faces rises above the plane across the normal of the nearer, in gaps. In
flat and convex surfaces it does not rise, s = 0, and M is the depth of the nearest alone; walls of
a crease rise, and with s = 1 each has a force of its own; between, M goes smoothly from one wall to
the other. No force jumps, therefore. The forces are the gradient of the energy but for that of p,
which changes in creases below 26 degrees alone; across the middle of one the stiffness is at most
(p - 1) c / 2 < FAR of k, however flat it is. A ball presses dents, whose faces turn below it by as
much as those of a crease, and what p then adds to the energy of the ball would be none of its own;
so its walls are those that the surface had at the start, and in a dent it touches the nearest face.
Consequence to test: between two walls a probe is in equilibrium in the middle, with the stiffness
of both; a ball that dents a plate makes no energy.
"""

from math import sqrt

from crashsolve.contact.cells import WALLS
from crashsolve.contact.narrow._face import nearest_on_face, point_of
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import dot, put, scale, sub, vec
from crashsolve.system.contact.projection import NO_DISTANCE, relative_corners, row_of, side_of

# of the gap: a wall that rises so far above the plane of the nearer is separate from it
FULL_SEPARATION = 0.1
# of that: below, both are one wall
LEAST_SEPARATION = 2e-3
# above any separation of two walls, from 0 to 1
ABOVE_SEPARATION = 2.0
# above any cosine of two normals
ABOVE_COSINE = 4.0


@kernel
def row_of_wall(s, w):
    """Row of the wall w on a side in `hits`; those of the nearest come first."""
    return s if w == 0 else 2 + (WALLS - 1) * s + w - 1


@kernel
def find_walls(i, x, p, totals, sides, mesh, lists, initial):
    """Find the walls beside the nearest, on both sides. Writes: sides.hits."""
    for s in range(2):
        nearest = sides.hits[s]
        has_normal = nearest.distance > NO_DISTANCE * p.gap
        if nearest.depth > 0.0 and nearest.crossed == 0 and has_normal:
            find_adjacent_walls(i, s, x, p, totals, sides, mesh, lists, initial)


@kernel
def find_adjacent_walls(i, s, x, p, totals, sides, mesh, lists, initial):
    """Walls beside the nearest on one side, first those with most energy. Writes: sides.hits."""
    hits, count = sides.hits, 1
    for w in range(1, WALLS):
        if count == w and find_next_wall(i, s, w, x, p, totals, sides, mesh, lists, initial):
            count += 1
    hits[s].other_walls = count - 1
    distribute_force(s, count, p, hits, initial)


@kernel
def distribute_force(s, count, p, hits, initial):
    """Weights of the forces of all walls; those with the least separation are merged first.

    The separation of two groups is the least of their walls.

    Writes: hits.
    """
    for w in range(count):
        hit = hits[row_of_wall(s, w)]
        hit.group, hit.joined = w, hit.depth
    for _ in range(count - 1):
        least, one, two = ABOVE_SEPARATION, 0, 0
        for v in range(count):
            for w in range(v + 1, count):
                a, b = hits[row_of_wall(s, v)], hits[row_of_wall(s, w)]
                if a.group != b.group:
                    apart = separation_of(p, s, a, vec(b.normal), b.distance, b.face, initial)
                    if apart < least:
                        least, one, two = apart, v, w
        merge_groups(s, count, least, hits[row_of_wall(s, one)], hits[row_of_wall(s, two)], hits)


@kernel
def merge_groups(s, count, apart, one, two, hits):
    """Merge the groups of two walls with this separation. Writes: hits."""
    group, other = one.group, two.group
    share, share_of_other, depth = merged_weights(one.joined, two.joined, apart)
    for w in range(count):
        hit = hits[row_of_wall(s, w)]
        if hit.group == group or hit.group == other:
            hit.weight *= share if hit.group == group else share_of_other
            hit.group, hit.joined = group, depth


@kernel
def merged_weights(one, two, apart):
    """Weights of two depths [m] and the depth M of both [m]."""
    power = 2.0 / max(apart, LEAST_SEPARATION)
    low, high = min(one, two), max(one, two)
    combined = high * (1.0 + (low / high) ** power) ** (1.0 / power)
    return (one / combined) ** (power - 2.0), (two / combined) ** (power - 2.0), combined


@kernel
def separation_of(p, s, other, n, distance, face, initial):
    """Separation, 0 to 1, of a wall with this normal, distance and face from another."""
    if initial.shape[0] > 0:
        return separation_at_start(s, initial[face], initial[other.face])
    cosine = dot(n, vec(other.normal))
    low, high = min(distance, other.distance), max(distance, other.distance)
    return min(max((low - high * cosine) / (FULL_SEPARATION * p.gap), 0.0), 1.0)


@kernel
def separation_at_start(s, one, two):
    """Separation, 0 to 1, of two faces seen from side s as they were at the start.

    Each must rise above the plane of the other: which of both is nearer does not matter.
    """
    n, m, to = vec(one.normal), vec(two.normal), sub(vec(two.middle), vec(one.middle))
    sign = 1.0 if s == 0 else -1.0
    if min(sign * dot(n, to), -sign * dot(m, to)) <= 0.0:
        return 0.0
    return min((1.0 - dot(n, m)) / FULL_SEPARATION, 1.0)


@kernel
def find_next_wall(i, s, w, x, p, totals, sides, mesh, lists, initial):
    """Whether there is one more wall beside w others; store it. Writes: sides.hits."""
    first, near, wait, _ = lists
    best, hit = 0.0, sides.hits[row_of_wall(s, w)]
    for k in range(first[i], first[i + 1]):
        f = near[k]
        # a face that is not due yet is farther than the gap
        if mesh[5][f] == 1 or wait[k] > totals.travel or f == sides.hits[s].face:
            continue
        a, b, c, d = relative_corners(x, p, f, mesh)
        N, square, spot = nearest_on_face(a, b, c, d)
        distance = sqrt(square)
        if distance >= p.gap or distance <= NO_DISTANCE * p.gap:
            continue
        to = point_of(N, a, b, c, d)
        n, depth = scale(-1.0 / distance, to), p.gap - distance
        apart = separation_from(s, w, p, f, distance, n, sides.hits, initial)
        if apart < LEAST_SEPARATION or apart * depth * depth <= best:
            continue
        on, crossed = side_of(i, p, f, spot, to, sides.states, sides.slot_in_use, mesh)
        if on == s and crossed == 0:
            best = apart * depth * depth
            store_wall(hit, p, f, N, distance, n)
    return best > 0.0


@kernel
def store_wall(hit, p, f, N, distance, n):
    """Store a wall; its weight follows. Writes: hit."""
    hit.face, hit.distance, hit.depth, hit.crossed = f, distance, p.gap - distance, 0
    hit.weight = 1.0
    put(hit.normal, n)
    for k in range(4):
        hit.N[k] = N[k]
    if f >= p.quads:
        hit.N[2], hit.N[3] = N[2] + N[3], 0.0


@kernel
def separation_from(s, w, p, face, distance, n, hits, initial):
    """Separation of a wall from w others, from 0 to 1."""
    apart = 1.0
    for v in range(w):
        other = hits[row_of_wall(s, v)]
        apart = min(apart, separation_of(p, s, other, n, distance, face, initial))
    return apart


@kernel
def wall_count(s, hits):
    """Number of walls that a probe touches on a side."""
    return 1 + hits[s].other_walls if hits[s].depth > 0.0 else 0


@kernel
def old_wall_count(old):
    """Number of walls that it touched before, of which `old` is the record of the first."""
    return 1 + old.other_walls if old.active == 1 else 0


@kernel
def match_walls(p, j, s, count, before, hits, probe_states, slot_in_use):
    """Number of the wall touched before that each of `count` continues: the same face, or the
    nearest normal.

    Returns the sum of 2^r over the walls r that continue. Writes: hits.
    """
    for w in range(count):
        hits[row_of_wall(s, w)].partner = -1
    taken = 0
    for _ in range(min(count, before)):
        best, hit_of_best, old_of_best = -2.0, 0, 0
        for w in range(count):
            hit = hits[row_of_wall(s, w)]
            if hit.partner >= 0:
                continue
            for r in range(before):
                if taken >> r & 1:
                    continue
                old = probe_states[slot_in_use[j], row_of(p, j, r)]
                score = dot(vec(old.normal), vec(hit.normal))
                if old.face == hit.face:
                    score += ABOVE_COSINE
                if score > best:
                    best, hit_of_best, old_of_best = score, w, r
        hits[row_of_wall(s, hit_of_best)].partner = old_of_best
        taken += 1 << old_of_best
    return taken
