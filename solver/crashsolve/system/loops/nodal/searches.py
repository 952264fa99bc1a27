"""What one probe finds: the nearest faces of a shell on both sides of it, or the deepest shape.

It depends on positions alone, and on no force, so several threads may look for different probes.
"""

from crashsolve.foundation.kernels import apart
from crashsolve.system.contact import (
    ellipsoids,
    node_contact,
    normals,
    pass_through,
    projection,
    walls,
)


@apart
def search_faces(group, i, hits, nodes, scene):
    """The nearest face on either side of a probe.

    Writes: hits, near lists, ellipsoids.
    """
    p, totals, points = group.p[0], group.totals[0], scene.points
    sides, deleted = projection.Sides(group.probe_states, group.slot_in_use, hits), group.deleted
    lists = (group.first, group.near, group.wait, group.due)
    mesh = (points, scene.corners, group.adjacent, group.around_first, group.around, deleted)
    excluded = (group.excluded_first, group.excluded)
    if group.is_round:
        ellipsoid = group.ellipsoids[i]
        ellipsoids.find_nearest_faces(i, p, totals, ellipsoid, nodes, sides, mesh, lists)
        if group.is_smooth:
            x, probe_element = ellipsoids.centre_of(ellipsoid, nodes)
            normals.apply_field(i, x, probe_element, p, mesh, excluded, hits)
    else:
        x, _ = node_contact.position_and_velocity(group.probes[i], 0.0, nodes, points)
        projection.find_nearest_faces(i, x, p, totals, sides, mesh, lists)
        if group.is_smooth:
            normals.apply_field(i, x, None, p, mesh, excluded, hits)
        else:
            walls.find_walls(i, x, p, totals, sides, mesh, lists, group.initial)


@apart
def search_shapes(group, i, probe_element, v, hit, nodes, scene):
    """The shape in which a probe of velocity v is deepest; whether it continues with its own face,
    and how far it is past the middle of that. Writes: hit, turns, due, a copy of a body.
    """
    p, totals, frames, shapes = group.p[0], group.totals[0], group.frames, group.b
    x, _ = node_contact.position_and_velocity(group.probes[i], 0.0, nodes, scene.points)
    node_contact.place_probe(frames[probe_element.node], x, hit)
    old = group.probe_states[node_contact.accept_record(group.slot_in_use, i), i]
    retained, over = False, -1.0
    for e in range(shapes.shape[0]):
        depth, n, _ = group.narrow.gap(probe_element, shapes[e], frames, group.data)
        if (
            group.keeps_faces
            and old.face == e
            and pass_through.is_another_face(old, depth, n, p.gap)
        ):
            u = node_contact.body_velocity(nodes[group.frame_bodies[shapes[e].node]], x)
            kept = group.narrow.gap_by(probe_element, shapes[e], frames, group.data, old.normal)
            if pass_through.may_retain_face(old, v, u, n, kept):
                retained = True
                depth, n, _, over = kept
        if group.has_core_depth and old.face == e and depth > p.gap:
            over = max(over, depth - group.narrow.middle(probe_element, shapes[e], frames, n))
        node_contact.keep_deepest(hit, e, depth, n)
    node_contact.set_due(i, hit, totals, group.due)
    return retained, over
