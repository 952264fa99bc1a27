"""Nodes of shells, balls and ellipsoids on the faces of a shell: the probes of one group."""

from crashsolve.contact.cells import WALLS, Near
from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.contact import (
    ellipsoids,
    node_contact,
    projection,
    surface_friction,
    touches,
    walls,
    work,
)
from crashsolve.system.contact.pair import Pressing, Touch
from crashsolve.system.loops.nodal.searches import look_at_faces
from crashsolve.system.loops.nodal.surface_friction import friction_on_face
from crashsolve.system.loops.pieces import find_fastest, share_looks
from crashsolve.system.placeholders import THREADS


@kernel
def node_to_surface(group, clock, h, nodes, curves, scene):
    """Forces of all probes of a group. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals, probes, due = group.p[0], group.totals[0], group.probes, group.due
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    lists = (group.first, group.near, group.wait, due)
    grid = (group.cells, group.starts, group.sorted)
    spared = (group.spared_first, group.spared)
    if THREADS:
        find_fastest(p, clock, h, scene)
    projection.open_faces(h, p, totals, probes, nodes, scene, Near(grid, lists, spared))
    if group.can_fail:
        projection.remove_near_faces(p, scene.lanes, group.gone)
    if THREADS:
        share_looks(group, clock, h, scene)
        for k in range(group.looks.shape[0]):
            one = group.looks[k]
            for j in range(one.first, one.first + one.count):
                i = group.seen[j].probe
                touch_faces(group, clock, h, i, group.found[i], nodes, curves, scene)
    else:
        for i in range(probes.shape[0]):
            if due[i] <= totals.travel:
                look_at_faces(group, i, group.found[0], nodes, scene)
                touch_faces(group, clock, h, i, group.found[0], nodes, curves, scene)
    node_contact.close_pass(totals, card, counts[p.card])


@kernel
def touch_faces(group, clock, h, i, found, nodes, curves, scene):
    """Forces of one probe on the faces it has found, or left. Writes: as above."""
    probe_states, slot_in_use = group.probe_states, group.slot_in_use
    mesh = (scene.points, scene.corners, group.beside, group.around_first, group.around, group.gone)
    for s in range(2):
        j = 2 * i + s
        if found[s].depth > 0.0 or probe_states[slot_in_use[j], j].active == 1:
            touch_side(group, clock, h, (i, s), found, nodes, curves, mesh, scene)
            node_contact.swap_slot(h, slot_in_use, j)


@kernel
def touch_side(group, clock, h, at, found, nodes, curves, mesh, scene):
    """Forces of a probe on the walls on one side of it. Writes: as above."""
    (i, s), p, states = at, group.p[0], group.probe_states
    j, slot_in_use = 2 * i + s, group.slot_in_use
    done = scene.card_history[1 - clock.current, p.card]
    now, none = slot_in_use[j], WALLS * p.first_beside
    count, before = walls.touching(s, found), walls.touched(states[now, j])
    taken = walls.pair_up(p, j, s, count, before, found, states, slot_in_use)
    probe, v = group.probes[i], (0.0, 0.0, 0.0)
    if group.is_round:
        probe = group.balls[i]
    else:
        _, v = node_contact.where(probe, h, nodes, scene.points)
    for w in range(count):
        hit = found[walls.number_of(s, w)]
        # a new touch has no history, except that of a probe that is apart
        row = none if before > 0 or w > 0 else j
        if hit.partner >= 0:
            row = projection.row_of(p, j, hit.partner)
        old, new = states[now, row], states[1 - now, projection.row_of(p, j, w)]
        past = past_of(h, p, probe, old, done, nodes, scene)
        if group.is_round:
            v = ellipsoids.roll(probe, p, hit, nodes, scene.points, scene.corners)
        touch = Touch(j, probe, None, v, old, new, hit, past)
        press_on_face(group, clock, h, touch, nodes, curves, scene)
    for r in range(before):
        if taken >> r & 1 == 0:
            old = states[now, projection.row_of(p, j, r)]
            new = states[1 - now, j if count == 0 and r == 0 else none]
            past = past_of(h, p, probe, old, done, nodes, scene)
            touch = Touch(j, probe, None, v, old, new, found[s], past)
            leave_face(group, clock, h, touch, mesh, scene)
    states[1 - now, j].beside = max(count - 1, 0)


@kernel
def past_of(h, p, probe, old, count, nodes, scene):
    """Displacement of a probe over the face that it has touched; its work. Writes: count."""
    past = (0.0, 0.0, 0.0)
    if old.active == 1:
        past = work.displacement_over_face(
            p, probe, old, True, h, nodes, scene.points, scene.corners
        )
        work.push_along(old, past, count)
    return past


@stage
def leave_face(group, clock, h, touch, mesh, scene):
    """A probe leaves a face. Writes: totals, probe_states, card_history."""
    p, totals = group.p[0], group.totals[0]
    count = scene.card_history[1 - clock.current, p.card]
    old, new = touch.old, touch.new
    if group.can_fail:
        projection.drop_energy(h, totals, old, 0.0, group.gone)
    projection.note_lost(clock, h, p, totals, old, mesh)
    node_contact.leave(clock, totals, old, new)
    group.normal.release(p, old, new)
    if group.friction:
        surface_friction.leave(h, totals, touch.past, old, new, count)
        group.friction.release(p, old, new)


@stage
def press_on_face(group, clock, h, touch, nodes, curves, scene):
    """Forces of one probe on one face. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals = group.p[0], group.totals[0]
    _, probe, _, v, old, new, hit, _ = touch
    points, corners = scene.points, scene.corners
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    mob = node_contact.mobility_of(probe, hit, nodes, points)
    mob_face, w = projection.face_mobility(p, hit, points, corners)
    w += node_contact.probe_predicts(probe, hit, points)
    mass = 1.0 / max(mob + mob_face, node_contact.STUCK)
    u = projection.face_velocity(p, hit, h, points, corners)
    rate = node_contact.closing(v, u, hit, h, old, w)
    touches.latch(p, old, new, hit.depth, rate, counts[p.card])
    f, stored, power, loss, k, c = group.normal.normal_force(
        p, old, new, h, hit.depth, rate, mass, curves
    )
    share = hit.weight
    f, stored, power, loss = share * f, share * stored, share * power, share * loss
    k, c = share * k, share * c
    displacement = work.displacement_over_face(p, probe, hit, False, h, nodes, points, corners)
    if group.can_fail:
        projection.drop_energy(h, totals, old, stored, group.gone)
    if group.friction:
        pressing = Pressing(f, mass, displacement)
        friction_on_face(group, clock, h, touch, pressing, nodes, scene)
    node_contact.push_probe(probe, f, k, c, hit, nodes, scene)
    projection.push_face(p, hit, f, k, c, scene)
    node_contact.note(clock, h, p, totals, card, touch, f, (stored, power, loss))
    work.push_along(new, displacement, count)
