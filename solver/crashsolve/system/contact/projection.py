"""Faces of shells as targets of probes: nearest point, side, force spread by its weights.

    d = |x - c|,   n = (x - c) / d,   depth = gap - d,   f n on the probe, -f N_k n on the corners

c is the nearest point of the mid-surface. A probe may be on either side of it, and meets one face
on each side: the nearest. Its side is determined when it comes nearer than the gap, by the normal
there (of both faces at a common edge, of all at a common corner, weighted by angle), and stored: if
the probe is driven through the mid-surface, x - c reverses from one step to the next, and
depth = gap + d pushes it back. No step brings two sides nearer by more than half of the gap, so no
crossing is missed; a face that was farther, or is on the side in contact, has not been crossed: it
is the other wall of a fold. Consequence to test: momentum and angular momentum are conserved to
round-off, since f acts along the line through x and c.

References: Baerentzen and Aanaes (2005), IEEE Transactions on Visualization and Computer Graphics
11, 243-253.
"""

from math import acos, sqrt
from typing import NamedTuple

from crashsolve.contact.cells import WALLS, bound_faces, corner_points, list_near, sort_faces
from crashsolve.contact.narrow._face import (
    CORNER,
    EDGE,
    INSIDE,
    nearest_on_face,
    normal_vector,
    point_of,
)
from crashsolve.elements.shells.records import BLOCK
from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.rows import Rows
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.system.contact.node_contact import (
    accept_record,
    add_point_stiffness,
    clear_sums,
    fastest,
    mobility_along,
    position_and_velocity,
    predicted_mobility,
    predicted_velocity,
)

# a distance of this share of the gap has no direction
NO_DISTANCE = 1e-9
# of `reach`, the distance from which a face may be crossed in a step: speeds may grow within it
CROSSED = 1.5


@kernel
def update_face_lists(h, p, totals, probes, nodes, scene, near_faces):
    """Add to the travel of all; renew the lists where it exceeds their margin.

    Writes: totals, near_faces.
    """
    points, corners = scene.points, scene.corners
    clear_sums(totals)
    totals.fastest = 2.0 * fastest(h, p, probes, nodes, scene)
    totals.travel += h * totals.fastest
    if totals.travel <= totals.listed + p.margin:
        return
    (cells, starts, sorted_faces), (first, _, _, due), _ = near_faces
    reach = p.gap + p.over + p.margin
    width = bound_faces(p, points, corners, cells) + reach
    sort_faces(p, width, cells, starts, sorted_faces)
    total = 0
    for i in range(probes.shape[0]):
        x, _ = position_and_velocity(probes[i], 0.0, nodes, points)
        first[i], due[i] = min(total, p.room), totals.travel
        total = list_near(i, x, p, totals.travel, reach, width, near_faces, total)
    first[probes.shape[0]] = min(total, p.room)
    totals.listed, totals.pairs = totals.travel, total
    totals.searches += 1


@kernel
def remove_near_faces(p, blocks, deleted):
    """Remove the faces of deleted elements from contact. Writes: deleted."""
    for f in range(p.face_count):
        first, stride, k = p.first_number, p.stride, f
        if f >= p.quads:
            first, stride, k = p.first_third, p.stride_third, f - p.quads
        t = blocks[first + k // LANES * stride + LANES * BLOCK.thickness + k % LANES]
        deleted[f] = 1 if t == 0.0 else 0


@kernel
def add_lost_energy(h, totals, old, stored, deleted):
    """Count the stored energy of a touch that is lost with an element. Writes: totals."""
    if h > 0.0 and old.active == 1 and deleted[old.face] == 1:
        totals.dissipated += old.stored - stored


@kernel
def record_pass(clock, h, p, totals, old, mesh):
    """Record the time at which a probe behind its face has passed through the surface.

    Writes: totals.
    """
    is_behind = old.depth > p.gap and mesh[5][old.face] == 0
    if h > 0.0 and is_behind and totals.pass_time == 0.0:
        totals.pass_time = clock.time + h


@kernel
def needs_room(p, totals):
    """Whether the lists fill more than half of their room."""
    return 2 * totals.pairs > p.room


class Sides(NamedTuple):
    """Touches of probes, on both sides of the faces."""

    states: Rows  # before and after the step, `WALLS` for each side of each probe
    slot_in_use: int  # which of both is the accepted one
    hits: Rows  # the nearest faces of one probe


@kernel
def find_nearest_faces(i, x, p, totals, sides, mesh, lists):
    """The nearest face on either side of a probe at x, nearer than the gap. Writes: sides, lists.

    A face that is farther is due when the travel may have closed its gap.
    """
    first, near, wait, due = lists
    soonest = 1e300
    is_deep = reset_found(i, p, sides)
    for k in range(first[i], first[i + 1]):
        f = near[k]
        if mesh[5][f] == 1:
            continue
        if wait[k] <= totals.travel or is_deep:
            a, b, c, d = relative_corners(x, p, f, mesh)
            N, square, spot = nearest_on_face(a, b, c, d)
            distance = sqrt(square)
            wait[k] = totals.travel + max(distance - p.gap, 0.0)
            # a probe that has been driven through the surface is not released behind it
            if distance < p.gap or is_deep:
                to = point_of(N, a, b, c, d)
                keep_nearest(i, p, (f, N, spot), distance, to, sides, mesh)
        soonest = min(soonest, wait[k])
    due[i] = soonest
    report_depth(p, sides.hits)


@kernel
def reset_found(i, p, sides):
    """Reset the faces found; returns whether the probe is so deep that all faces are due.

    Writes: sides.
    """
    is_deep, (probe_states, slot_in_use, hits) = False, sides
    for s in range(2):
        hits[s].distance, hits[s].face, hits[s].depth = p.gap + p.margin, -1, 0.0
        hits[s].other_walls, hits[s].weight = 0, 1.0
        old = probe_states[accept_record(slot_in_use, 2 * i + s), 2 * i + s]
        is_deep = is_deep or (old.active == 1 and old.depth > 0.5 * p.gap)
    return is_deep


@kernel
def report_depth(p, hits):
    """Depths of the faces found, from their distances. Writes: hits."""
    for s in range(2):
        if hits[s].face >= 0:
            hits[s].depth = p.gap - (-1.0 if hits[s].crossed == 1 else 1.0) * hits[s].distance


@kernel
def relative_corners(x, p, f, mesh):
    """Corners of a face relative to a position."""
    points, at = mesh[0], corner_points(p, f, mesh[1])
    return (
        sub(vec(points[at[0]].r), x),
        sub(vec(points[at[1]].r), x),
        sub(vec(points[at[2]].r), x),
        sub(vec(points[at[3]].r), x),
    )


@kernel
def keep_nearest(i, p, face, distance, to, sides, mesh):
    """Store a face if it is the nearest on its side, at a distance [m]; `to` is the vector to it.

    `face`: its number, the weights of its corners at the nearest point, the feature of that.
    Writes: sides.hits.
    """
    (f, N, spot), (probe_states, slot_in_use, hits) = face, sides
    s, crossed = side_of(i, p, f, spot, to, probe_states, slot_in_use, mesh)
    hit = hits[s]
    if distance >= hit.distance or (distance >= p.gap and crossed == 0):
        return
    hit.distance, hit.face, hit.crossed = distance, f, crossed
    for k in range(4):
        hit.N[k] = N[k]
    if f >= p.quads:
        hit.N[2], hit.N[3] = N[2] + N[3], 0.0
    old = probe_states[slot_in_use[2 * i + s], 2 * i + s]
    if distance > NO_DISTANCE * p.gap:
        put(hit.normal, scale((1.0 if crossed == 1 else -1.0) / distance, to))
    elif old.active == 1:
        put(hit.normal, vec(old.normal))
    else:
        n = face_normal(p, f, mesh)
        put(hit.normal, scale(1.0 if s == 0 else -1.0, n))


@kernel
def side_of(i, p, f, spot, to, probe_states, slot_in_use, mesh):
    """Side of a face on which a probe is, 0 that of the normal; 1 if it has crossed from there."""
    up = adjacent_touch(2 * i, p, f, probe_states, slot_in_use, mesh)
    down = adjacent_touch(2 * i + 1, p, f, probe_states, slot_in_use, mesh)
    is_up, is_down = up >= 0, down >= 0
    side = 0 if dot(to, surface_normal(p, f, spot, mesh)) <= 0.0 else 1
    if is_up == is_down:
        return side, 0
    s = 0 if is_up else 1
    kept = probe_states[slot_in_use[2 * i + s], up if is_up else down]
    if dot(to, vec(kept.normal)) <= 0.0:
        return s, 0
    # the other wall of a fold is on the same side, or too far to be crossed in a step; the way
    # around a free border is no crossing
    is_deep = kept.depth > p.gap - CROSSED * p.reach
    if side != s and is_deep and not on_border(p, f, spot, mesh):
        return s, 1
    return side, 0


@kernel
def row_of(p, j, w):
    """Row of the record of the wall w on side j of all probes; those of the nearest come first."""
    return j if w == 0 else p.first_other_wall + (WALLS - 1) * j + w - 1


@kernel
def adjacent_touch(j, p, f, probe_states, slot_in_use, mesh):
    """Row of the deepest contact, on side j of all probes, with a face beside another; -1: none."""
    now, best, depth = slot_in_use[j], -1, -1e300
    if probe_states[now, j].active == 0:
        return best
    for w in range(1 + probe_states[now, j].other_walls):
        at = row_of(p, j, w)
        old = probe_states[now, at]
        if old.depth > depth and share_corner(p, f, old.face, mesh):
            best, depth = at, old.depth
    return best


@kernel
def share_corner(p, f, g, mesh):
    """Whether two faces have a corner in common."""
    a, b = corner_points(p, f, mesh[1]), corner_points(p, g, mesh[1])
    for m in range(4):
        for n in range(4):
            if a[m] == b[n]:
                return True
    return False


@kernel
def on_border(p, f, spot, mesh):
    """Whether a position of a face lies on a free border."""
    if spot == INSIDE:
        return False
    if spot < CORNER:
        return adjacent_face(f, spot - EDGE, mesh) < 0
    first, faces = mesh[3], mesh[4]
    point = corner_points(p, f, mesh[1])[spot - CORNER]
    own = point - p.first_own
    for k in range(first[own], first[own + 1]):
        g = faces[k]
        at, last = corner_points(p, g, mesh[1]), 3
        for c in range(4):
            ends = adjacent_face(g, c, mesh) < 0 or adjacent_face(g, last, mesh) < 0
            if mesh[5][g] == 0 and at[c] == point and ends:
                return True
            last = c
    return False


@kernel
def adjacent_face(f, k, mesh):
    """The face across an edge; -1: none. Across its edge of no length a triangle has itself."""
    g = mesh[2][4 * f + k]
    return -1 if g < 0 or mesh[5][g] == 1 else g


@kernel
def face_normal(p, f, mesh):
    """Unit normal of a face."""
    points, at = mesh[0], corner_points(p, f, mesh[1])
    n = normal_vector(
        vec(points[at[0]].r), vec(points[at[1]].r), vec(points[at[2]].r), vec(points[at[3]].r)
    )
    return scale(1.0 / norm(n), n)


@kernel
def surface_normal(p, f, spot, mesh):
    """Normal of the surface at a position of a face."""
    n = face_normal(p, f, mesh)
    if spot == INSIDE:
        return n
    if spot < CORNER:
        g = adjacent_face(f, spot - EDGE, mesh)
        return n if g < 0 else add(n, face_normal(p, g, mesh))
    first, faces = mesh[3], mesh[4]
    point = corner_points(p, f, mesh[1])[spot - CORNER]
    own, total = point - p.first_own, (0.0, 0.0, 0.0)
    for k in range(first[own], first[own + 1]):
        g = faces[k]
        if mesh[5][g] == 0:
            total = add_scaled(total, angle_at(p, g, point, mesh), face_normal(p, g, mesh))
    return total


@kernel
def angle_at(p, f, point, mesh):
    """Angle of a face at one of its corners [rad]."""
    points, at = mesh[0], corner_points(p, f, mesh[1])
    for k in range(4):
        if at[k] == point:
            x = vec(points[point].r)
            # the third corner of a triangle comes twice
            ahead = (k + 2) % 4 if at[(k + 1) % 4] == point else (k + 1) % 4
            u = sub(vec(points[at[ahead]].r), x)
            v = sub(vec(points[at[(k + 3) % 4]].r), x)
            cosine = dot(u, v) / sqrt(dot(u, u) * dot(v, v))
            return acos(min(max(cosine, -1.0), 1.0))
    return 0.0


@kernel
def face_velocity(p, hit, h, points, corners):
    """Velocity of the point of a face in contact."""
    at, v = corner_points(p, hit.face, corners), (0.0, 0.0, 0.0)
    for k in range(4):
        v = add_scaled(v, hit.N[k], predicted_velocity(points[at[k]], h))
    return v


@kernel
def face_mobility(p, hit, points, corners):
    """Acceleration of that point per unit force [1/kg], and the predicted part of it."""
    at, n, w, predicted_w = (
        corner_points(p, hit.face, corners),
        vec(hit.normal),
        0.0,
        0.0,
    )
    for k in range(4):
        b, square = points[at[k]], hit.N[k] * hit.N[k]
        w += square * mobility_along(b, n)
        predicted_w += square * predicted_mobility(b, n)
    return w, predicted_w


@kernel
def apply_to_face(p, hit, f, k, c, scene):
    """Apply minus a force f along the normal to the corners. Writes: scene.points, stiffened."""
    at = corner_points(p, hit.face, scene.corners)
    for j in range(4):
        add_to(scene.points[at[j]].force, scale(-f * hit.N[j], vec(hit.normal)))
        add_point_stiffness(at[j], hit.N[j], k, c, scene)
