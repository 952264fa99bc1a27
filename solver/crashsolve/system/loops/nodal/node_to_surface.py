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
from crashsolve.system.contact.pair import ProbeResponse, Touch
from crashsolve.system.loops.nodal.searches import search_faces
from crashsolve.system.loops.nodal.surface_friction import friction_on_face
from crashsolve.system.loops.pieces import find_fastest, share_search
from crashsolve.system.placeholders import THREADS


@kernel
def node_to_surface(group, clock, h, nodes, curves, scene):
    """Forces of all probes of a group. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals, probes, due = group.p[0], group.totals[0], group.probes, group.due
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    lists = (group.first, group.near, group.wait, due)
    grid = (group.cells, group.starts, group.sorted)
    excluded = (group.excluded_first, group.excluded)
    if THREADS:
        find_fastest(p, clock, h, scene)
    projection.update_face_lists(h, p, totals, probes, nodes, scene, Near(grid, lists, excluded))
    if group.can_fail:
        projection.remove_near_faces(p, scene.lanes, group.deleted)
    if THREADS:
        share_search(group, clock, h, scene)
        for k in range(group.search_ranges.shape[0]):
            one = group.search_ranges[k]
            for j in range(one.first, one.first + one.count):
                i = group.touching_probes[j].probe
                apply_face_forces(group, clock, h, i, group.hits[i], nodes, curves, scene)
    else:
        for i in range(probes.shape[0]):
            if due[i] <= totals.travel:
                search_faces(group, i, group.hits[0], nodes, scene)
                apply_face_forces(group, clock, h, i, group.hits[0], nodes, curves, scene)
    node_contact.add_energies(totals, card, counts[p.card])


@kernel
def apply_face_forces(group, clock, h, i, hits, nodes, curves, scene):
    """Forces of one probe on the faces it has found, or left. Writes: as above."""
    probe_states, slot_in_use = group.probe_states, group.slot_in_use
    mesh = (
        scene.points,
        scene.corners,
        group.adjacent,
        group.around_first,
        group.around,
        group.deleted,
    )
    for s in range(2):
        j = 2 * i + s
        if hits[s].depth > 0.0 or probe_states[slot_in_use[j], j].active == 1:
            apply_side_forces(group, clock, h, (i, s), hits, nodes, curves, mesh, scene)
            node_contact.mark_for_acceptance(h, slot_in_use, j)


@kernel
def apply_side_forces(group, clock, h, at, hits, nodes, curves, mesh, scene):
    """Forces of a probe on the walls on one side of it. Writes: as above."""
    (i, s), p, states = at, group.p[0], group.probe_states
    j, slot_in_use = 2 * i + s, group.slot_in_use
    done = scene.card_history[1 - clock.current, p.card]
    now, none = slot_in_use[j], WALLS * p.first_other_wall
    count, before = walls.wall_count(s, hits), walls.old_wall_count(states[now, j])
    taken = walls.match_walls(p, j, s, count, before, hits, states, slot_in_use)
    probe, v = group.probes[i], (0.0, 0.0, 0.0)
    if group.is_round:
        probe = group.balls[i]
    else:
        _, v = node_contact.position_and_velocity(probe, h, nodes, scene.points)
    for w in range(count):
        hit = hits[walls.row_of_wall(s, w)]
        # a new touch has no history, except that of a probe that is apart
        row = none if before > 0 or w > 0 else j
        if hit.partner >= 0:
            row = projection.row_of(p, j, hit.partner)
        old, new = states[now, row], states[1 - now, projection.row_of(p, j, w)]
        old_displacement = displacement_of_last_touch(h, p, probe, old, done, nodes, scene)
        if group.is_round:
            v = ellipsoids.place_ball(probe, p, hit, nodes, scene.points, scene.corners)
        touch = Touch(j, probe, None, v, old, new, hit, old_displacement)
        apply_forces_on_face(group, clock, h, touch, nodes, curves, scene)
    for r in range(before):
        if taken >> r & 1 == 0:
            old = states[now, projection.row_of(p, j, r)]
            new = states[1 - now, j if count == 0 and r == 0 else none]
            old_displacement = displacement_of_last_touch(h, p, probe, old, done, nodes, scene)
            touch = Touch(j, probe, None, v, old, new, hits[s], old_displacement)
            end_face_contact(group, clock, h, touch, mesh, scene)
    states[1 - now, j].other_walls = max(count - 1, 0)


@kernel
def displacement_of_last_touch(h, p, probe, old, count, nodes, scene):
    """Displacement of a probe over the face that it has touched; its work. Writes: count."""
    old_displacement = (0.0, 0.0, 0.0)
    if old.active == 1:
        old_displacement = work.displacement_over_face(
            p, probe, old, True, h, nodes, scene.points, scene.corners
        )
        work.add_normal_work(old, old_displacement, count)
    return old_displacement


@stage
def end_face_contact(group, clock, h, touch, mesh, scene):
    """A probe leaves a face. Writes: totals, probe_states, card_history."""
    p, totals = group.p[0], group.totals[0]
    count = scene.card_history[1 - clock.current, p.card]
    old, new = touch.old, touch.new
    if group.can_fail:
        projection.add_lost_energy(h, totals, old, 0.0, group.deleted)
    projection.record_pass(clock, h, p, totals, old, mesh)
    node_contact.release_record(clock, totals, old, new)
    group.normal.release(p, old, new)
    if group.friction:
        surface_friction.end_friction(h, totals, touch.old_displacement, old, new, count)
        group.friction.release(p, old, new)


@stage
def apply_forces_on_face(group, clock, h, touch, nodes, curves, scene):
    """Forces of one probe on one face. Writes: scene.points, cards, loads, probe_states, nodes."""
    p, totals = group.p[0], group.totals[0]
    _, probe, _, v, old, new, hit, _ = touch
    points, corners = scene.points, scene.corners
    card, counts = scene.cards[p.card], scene.card_history[1 - clock.current]
    count = counts[p.card]
    mob = node_contact.mobility_of(probe, hit, nodes, points)
    mob_face, w = projection.face_mobility(p, hit, points, corners)
    w += node_contact.predicted_probe_mobility(probe, hit, points)
    mass = 1.0 / max(mob + mob_face, node_contact.LEAST_MOBILITY)
    u = projection.face_velocity(p, hit, h, points, corners)
    rate = node_contact.closing_speed(v, u, hit, h, old, w)
    touches.latch(p, old, new, hit.depth, rate, counts[p.card])
    f, stored, power, loss, k, c = group.normal.normal_force(
        p, old, new, h, hit.depth, rate, mass, curves
    )
    share = hit.weight
    f, stored, power, loss = share * f, share * stored, share * power, share * loss
    k, c = share * k, share * c
    displacement = work.displacement_over_face(p, probe, hit, False, h, nodes, points, corners)
    if group.can_fail:
        projection.add_lost_energy(h, totals, old, stored, group.deleted)
    if group.friction:
        pressing = ProbeResponse(f, mass, displacement)
        friction_on_face(group, clock, h, touch, pressing, nodes, scene)
    node_contact.apply_to_probe(probe, f, k, c, hit, nodes, scene)
    projection.apply_to_face(p, hit, f, k, c, scene)
    node_contact.add_touch(clock, h, p, totals, card, touch, f, (stored, power, loss))
    work.add_normal_work(new, displacement, count)
