"""Nodes of shells on a shape of a rigid body: the probes of one group."""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.contact import node_contact, pass_through, surface_friction, touches, work
from crashsolve.system.contact.pair import ProbeHit, ProbeResponse, Touch
from crashsolve.system.loops.nodal.searches import search_shapes
from crashsolve.system.loops.nodal.surface_friction import friction_on_shape
from crashsolve.system.loops.pieces import find_fastest, share_search
from crashsolve.system.placeholders import THREADS


@kernel
def node_to_shape(group, clock, h, nodes, curves, scene):
    """Forces of all probes of a group. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals, probes, due = group.p[0], group.totals[0], group.probes, group.due
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    first_body = group.a.shape[0]
    if THREADS:
        find_fastest(p, clock, h, scene)
    copies = (group.frames, first_body, group.frame_bodies)
    node_contact.update_shapes(h, p, totals, probes, nodes, scene, copies)
    if THREADS and not group.keeps_faces:
        share_search(group, clock, h, scene)
        for k in range(group.search_ranges.shape[0]):
            one = group.search_ranges[k]
            for j in range(one.first, one.first + one.count):
                i = group.touching_probes[j].probe
                x, v = node_contact.position_and_velocity(probes[i], h, nodes, scene.points)
                nearest = ProbeHit(x, v, group.hits[i, 0], False, -1.0)
                apply_shape_forces(group, clock, h, i, nearest, nodes, curves, scene)
    else:
        for i in range(probes.shape[0]):
            if due[i] <= totals.travel:
                x, v = node_contact.position_and_velocity(probes[i], h, nodes, scene.points)
                hit = group.hits[0, 0]
                retained, over = search_shapes(group, i, group.a[0], v, hit, nodes, scene)
                nearest = ProbeHit(x, v, hit, retained, over)
                apply_shape_forces(group, clock, h, i, nearest, nodes, curves, scene)
    node_contact.add_energies(totals, card, counts[p.card])


@kernel
def apply_shape_forces(group, clock, h, i, nearest, nodes, curves, scene):
    """Forces of one probe on the shape it has found, or left. Writes: as above."""
    p, probes, shapes, points = group.p[0], group.probes, group.b, scene.points
    x, v, hit = nearest.x, nearest.v, nearest.hit
    now, count = group.slot_in_use[i], scene.card_history[1 - clock.current, p.card]
    old, new = group.probe_states[now, i], group.probe_states[1 - now, i]
    old_displacement = (0.0, 0.0, 0.0)
    if old.active == 1:
        body_before = nodes[group.frame_bodies[shapes[old.face].node]]
        old_displacement = work.displacement_over_body(
            p, probes[i], old, True, (body_before, x), h, nodes, points
        )
        work.add_normal_work(old, old_displacement, count)
    touch = Touch(i, probes[i], x, v, old, new, hit, old_displacement)
    if hit.depth > 0.0:
        apply_forces_on_shape(group, clock, h, touch, nearest, nodes, curves, scene)
        node_contact.mark_for_acceptance(h, group.slot_in_use, i)
    elif old.active == 1:
        end_shape_contact(group, clock, h, touch, nearest, count, scene)


@stage
def end_shape_contact(group, clock, h, touch, nearest, count, scene):
    """A probe leaves a shape. Writes: totals, probe_states, count."""
    p, totals = group.p[0], group.totals[0]
    old, new, hit = touch.old, touch.new, touch.hit
    node_contact.release_record(clock, totals, old, new)
    node_contact.mark_for_acceptance(h, group.slot_in_use, touch.number)
    group.normal.release(p, old, new)
    if group.keeps_faces:
        pass_through.record_probe(clock, h, p, old, new, hit, nearest.retained, nearest.over)
    elif group.has_ends:
        pass_through.record_round_probe(clock, h, p, old, new, hit)
    if group.friction:
        surface_friction.end_friction(h, totals, touch.old_displacement, old, new, count)
        group.friction.release(p, old, new)


@stage
def apply_forces_on_shape(group, clock, h, touch, nearest, nodes, curves, scene):
    """Forces of one probe on one shape. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals = group.p[0], group.totals[0]
    _, probe, x, v, old, new, hit, _ = touch
    points = scene.points
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    body = nodes[group.frame_bodies[group.b[hit.face].node]]
    mob = node_contact.body_mobility(body, x, hit)
    mass = 1.0 / max(
        mob + node_contact.mobility_of(probe, hit, nodes, points), node_contact.LEAST_MOBILITY
    )
    w = node_contact.predicted_probe_mobility(probe, hit, points)
    rate = node_contact.closing_speed(v, node_contact.body_velocity(body, x), hit, h, old, w)
    touches.latch(p, old, new, hit.depth, rate, counts[p.card])
    if group.keeps_faces:
        pass_through.record_probe(clock, h, p, old, new, hit, nearest.retained, nearest.over)
    elif group.has_ends:
        pass_through.record_round_probe(clock, h, p, old, new, hit)
    f, stored, power, loss, k, c = group.normal.normal_force(
        p, old, new, h, hit.depth, rate, mass, curves
    )
    displacement = work.displacement_over_body(p, probe, hit, False, (body, x), h, nodes, points)
    if group.friction:
        pressing = ProbeResponse(f, mass, displacement)
        friction_on_shape(group, clock, h, touch, pressing, nodes, scene)
    node_contact.apply_to_probe(probe, f, k, c, hit, nodes, scene)
    node_contact.apply_to_body(body, x, f, k, c, hit, mob)
    node_contact.add_touch(clock, h, p, totals, card, touch, f, (stored, power, loss))
    work.add_normal_work(new, displacement, count)
