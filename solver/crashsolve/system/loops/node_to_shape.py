"""Nodes of shells on a shape of a rigid body: the probes of one group."""

from crashsolve.foundation.compile import kernel, stage
from crashsolve.system import contacts, nodal, passing, rubbing, work
from crashsolve.system.loops.surface_friction import friction_on_shape


@kernel
def node_to_shape(group, clock, h, nodes, curves, scene):
    """Forces of all probes of a group. Writes: scene.points, cards, loads, slots, nodes."""
    p, tally, probes = group.p[0], group.tally[0], group.probes
    slots, turns, hit = group.slots, group.turns, group.found[0]
    points, shapes, due = scene.points, group.b, group.due
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    frames, home, pen = group.frames, group.home, group.a[0]
    nodal.open_shapes(h, p, tally, probes, nodes, scene, frames, home)
    for i in range(probes.shape[0]):
        if due[i] > tally.way:
            continue
        x, v = nodal.where(probes[i], h, nodes, points)
        nodal.pose(frames, x, hit)
        now = nodal.settle(turns, i)
        old, new = slots[now, i], slots[1 - now, i]
        held, over = False, -1.0
        for e in range(shapes.shape[0]):
            depth, n, _ = group.narrow.gap(pen, shapes[e], frames, group.data)
            if (
                group.keeps_faces
                and old.face == e
                and passing.is_another_face(old, depth, n, p.gap)
            ):
                u = nodal.body_velocity(nodes[home[shapes[e].node]], x)
                kept = group.narrow.gap_by(pen, shapes[e], frames, group.data, old.normal)
                if passing.keeps_face(old, v, u, n, kept):
                    held = True
                    depth, n, _, over = kept
            if group.knows_middle and old.face == e and depth > p.gap:
                over = max(over, depth - group.narrow.middle(pen, shapes[e], frames, n))
            nodal.deeper(hit, e, depth, n)
        nodal.wait_for(i, hit, tally, due)
        past = (0.0, 0.0, 0.0)
        if old.active == 1:
            home_before = nodes[home[shapes[old.face].node]]
            past = work.way_over_body(p, probes[i], old, True, x, home_before, h, nodes, points)
            work.push_along(old, past, count)
        if hit.depth <= 0.0:
            if old.active == 1:
                leave_shape(group, clock, h, i, old, new, past, hit, held, over, count, scene)
            continue
        press_on_shape(
            group, clock, h, i, x, v, old, new, hit, held, over, past, nodes, curves, scene
        )
        nodal.take_turn(h, turns, i)
    nodal.close_pass(tally, card, count)


@stage
def leave_shape(group, clock, h, i, old, new, past, hit, held, over, count, scene):
    """A probe leaves a shape. Writes: tally, slots, count."""
    p, tally = group.p[0], group.tally[0]
    nodal.leave(clock, h, tally, group.turns, i, old, new)
    group.normal.release(p, old, new)
    if group.keeps_faces:
        passing.note_probe(clock, h, p, old, new, hit, held, over)
    elif group.has_ends:
        passing.note_round_probe(clock, h, p, old, new, hit)
    if group.friction:
        rubbing.leave(h, tally, past, old, new, count)
        group.friction.release(p, old, new)


@stage
def press_on_shape(group, clock, h, i, x, v, old, new, hit, held, over, past, nodes, curves, scene):
    """Forces of one probe on one shape. Writes: scene.points, cards, loads, slots, nodes."""
    p, tally = group.p[0], group.tally[0]
    points, probes = scene.points, group.probes
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    body = nodes[group.home[group.b[hit.face].node]]
    mob = nodal.body_mobility(body, x, hit)
    mass = 1.0 / max(mob + nodal.mobility_of(probes[i], hit, nodes, points), nodal.STUCK)
    w = nodal.probe_foretells(probes[i], hit, points)
    rate = nodal.closing(v, nodal.body_velocity(body, x), hit, h, old, w)
    contacts.latch(p, old, new, hit.depth, rate, counts)
    if group.keeps_faces:
        passing.note_probe(clock, h, p, old, new, hit, held, over)
    elif group.has_ends:
        passing.note_round_probe(clock, h, p, old, new, hit)
    f, stored, power, loss, k, c = group.normal.normal_force(
        p, old, new, h, hit.depth, rate, mass, curves
    )
    way = work.way_over_body(p, probes[i], hit, False, x, body, h, nodes, points)
    if group.friction:
        friction_on_shape(
            group,
            clock,
            h,
            p,
            tally,
            probes[i],
            body,
            x,
            v,
            old,
            new,
            hit,
            past,
            way,
            f,
            mass,
            nodes,
            curves,
            scene,
        )
    nodal.push_probe(probes[i], f, k, c, hit, nodes, scene)
    nodal.push_body(body, x, f, k, c, hit, mob)
    nodal.note(clock, h, p, tally, card, f, stored, power, loss, old, new, hit)
    work.push_along(new, way, count)
