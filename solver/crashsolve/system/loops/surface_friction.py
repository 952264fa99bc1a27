"""Friction of one probe: on a face of a shell, and on a shape of a rigid body."""

from crashsolve.foundation.compile import stage
from crashsolve.system import contacts, nodal, rubbing, work


@stage
def friction_on_face(
    group, clock, h, probe, v, old, new, hit, past, way, f, mass, nodes, curves, scene
):
    """Writes: scene.points, loads, tally, cards, new."""
    p, tally = group.p[0], group.tally[0]
    points, corners = scene.points, scene.corners
    card, count = scene.cards[p.card], scene.card_history[1 - clock.current][p.card]
    d, e = work.arms(p, hit)
    a = rubbing.probe_foretells(probe, d, old, points)
    v_a = rubbing.probe_velocity(probe, v, d, h, nodes, points)
    a = rubbing.face_foretells(p, hit, e, old, a, points, corners)
    v_b = rubbing.face_velocity(p, hit, e, h, points, corners)
    slip, n = rubbing.slipping(v_a, v_b, hit, h, a)
    ease = 0.0
    if group.friction_damps:
        ahead = contacts.ahead(old, slip, n)
        ease = rubbing.ease_on_face(clock, h, p, probe, hit, d, e, ahead, f, nodes, scene)
    t, t_stored, _, t_loss, t_k, t_c = group.friction.friction_force(
        p, old, new, f, slip, work.along_plane(way, n), n, mass, ease, curves
    )
    ahead = contacts.along(t, slip, n)
    rubbing.rub_probe(probe, t, ahead, d, t_k, t_c, nodes, scene)
    rubbing.rub_face(p, hit, t, e, t_k, t_c, scene)
    rubbing.note(h, p, tally, card, t, t_stored, t_loss, new)
    if old.active == 1:
        work.rub_along(old, past, count)
    work.rub_along(new, way, count)


@stage
def friction_on_shape(
    group,
    clock,
    h,
    p,
    tally,
    probe,
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
):
    """Writes: scene.points, loads, tally, cards, new, body."""
    p, tally = group.p[0], group.tally[0]
    points = scene.points
    card, count = scene.cards[p.card], scene.card_history[1 - clock.current][p.card]
    d, y = rubbing.on_shape(p, hit, x)
    a = rubbing.probe_foretells(probe, d, old, points)
    v_a = rubbing.probe_velocity(probe, v, d, h, nodes, points)
    v_b = nodal.body_velocity(body, y)
    slip, n = rubbing.slipping(v_a, v_b, hit, h, a)
    ease = 0.0
    if group.friction_damps:
        ahead = contacts.ahead(old, slip, n)
        ease = rubbing.ease_on_shape(clock, h, probe, body, d, y, ahead, f, nodes, scene)
    t, t_stored, _, t_loss, t_k, t_c = group.friction.friction_force(
        p, old, new, f, slip, work.along_plane(way, n), n, mass, ease, curves
    )
    ahead = contacts.along(t, slip, n)
    rubbing.rub_probe(probe, t, ahead, d, t_k, t_c, nodes, scene)
    rubbing.rub_body(body, y, t, ahead, t_k, t_c)
    rubbing.note(h, p, tally, card, t, t_stored, t_loss, new)
    if old.active == 1:
        work.rub_along(old, past, count)
    work.rub_along(new, way, count)
