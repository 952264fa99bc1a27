"""Nodes of shells on a shape of a rigid body: the probes of one group."""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.contact import node_contact, passing, surface_friction, touches, work
from crashsolve.system.loops.surface_friction import friction_on_shape


@kernel
def node_to_shape(group, clock, h, nodes, curves, scene):
    """Forces of all probes of a group. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals, probes = group.p[0], group.totals[0], group.probes
    probe_states, turns, hit = group.probe_states, group.turns, group.found[0]
    points, shapes, due = scene.points, group.b, group.due
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    frames, home, pen = group.frames, group.home, group.a[0]
    node_contact.open_shapes(h, p, totals, probes, nodes, scene, frames, home)
    for i in range(probes.shape[0]):
        if due[i] > totals.way:
            continue
        x, v = node_contact.where(probes[i], h, nodes, points)
        node_contact.pose(frames, x, hit)
        now = node_contact.settle(turns, i)
        old, new = probe_states[now, i], probe_states[1 - now, i]
        held, over = False, -1.0
        for e in range(shapes.shape[0]):
            depth, n, _ = group.narrow.gap(pen, shapes[e], frames, group.data)
            if (
                group.keeps_faces
                and old.face == e
                and passing.is_another_face(old, depth, n, p.gap)
            ):
                u = node_contact.body_velocity(nodes[home[shapes[e].node]], x)
                kept = group.narrow.gap_by(pen, shapes[e], frames, group.data, old.normal)
                if passing.keeps_face(old, v, u, n, kept):
                    held = True
                    depth, n, _, over = kept
            if group.knows_middle and old.face == e and depth > p.gap:
                over = max(over, depth - group.narrow.middle(pen, shapes[e], frames, n))
            node_contact.deeper(hit, e, depth, n)
        node_contact.wait_for(i, hit, totals, due)
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
        node_contact.take_turn(h, turns, i)
    node_contact.close_pass(totals, card, count)


@stage
def leave_shape(group, clock, h, i, old, new, past, hit, held, over, count, scene):
    """A probe leaves a shape. Writes: totals, probe_states, count."""
    p, totals = group.p[0], group.totals[0]
    node_contact.leave(clock, h, totals, group.turns, i, old, new)
    group.normal.release(p, old, new)
    if group.keeps_faces:
        passing.note_probe(clock, h, p, old, new, hit, held, over)
    elif group.has_ends:
        passing.note_round_probe(clock, h, p, old, new, hit)
    if group.friction:
        surface_friction.leave(h, totals, past, old, new, count)
        group.friction.release(p, old, new)


@stage
def press_on_shape(group, clock, h, i, x, v, old, new, hit, held, over, past, nodes, curves, scene):
    """Forces of one probe on one shape. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals = group.p[0], group.totals[0]
    points, probes = scene.points, group.probes
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    body = nodes[group.home[group.b[hit.face].node]]
    mob = node_contact.body_mobility(body, x, hit)
    mass = 1.0 / max(
        mob + node_contact.mobility_of(probes[i], hit, nodes, points), node_contact.STUCK
    )
    w = node_contact.probe_foretells(probes[i], hit, points)
    rate = node_contact.closing(v, node_contact.body_velocity(body, x), hit, h, old, w)
    touches.latch(p, old, new, hit.depth, rate, counts)
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
            totals,
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
    node_contact.push_probe(probes[i], f, k, c, hit, nodes, scene)
    node_contact.push_body(body, x, f, k, c, hit, mob)
    node_contact.note(clock, h, p, totals, card, f, stored, power, loss, old, new, hit)
    work.push_along(new, way, count)
