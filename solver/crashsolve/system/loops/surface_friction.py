"""Friction of one probe: on a face of a shell, and on a shape of a rigid body."""

from crashsolve.foundation.kernels import stage
from crashsolve.system.contact import node_contact, surface_friction, touches, work
from crashsolve.system.contact.pair import Slide


@stage
def friction_on_face(group, clock, h, touch, pressing, nodes, curves, scene):
    """Writes: scene.points, loads, totals, cards, new."""
    p, totals = group.p[0], group.totals[0]
    _, probe, _, v, old, new, hit, past = touch
    f, mass, way = pressing
    points, corners = scene.points, scene.corners
    card, count = scene.cards[p.card], scene.card_history[1 - clock.current][p.card]
    d, e = work.arms(p, hit)
    a = surface_friction.probe_foretells(probe, d, old, points)
    v_a = surface_friction.probe_velocity(probe, v, d, h, nodes, points)
    a = surface_friction.face_foretells(p, hit, e, old, a, points, corners)
    v_b = surface_friction.face_velocity(p, hit, e, h, points, corners)
    slip, n = surface_friction.slipping(v_a, v_b, hit, h, a)
    ease = 0.0
    if group.friction_damps:
        ahead = touches.ahead(old, slip, n)
        rates = surface_friction.pressed_on_face(h, p, touch, (d, e), ahead, f, nodes, scene)
        ease = surface_friction.ease_under(clock, h, rates, f)
    slide = Slide(f, slip, work.along_plane(way, n), n, mass, ease)
    t, t_stored, _, t_loss, t_k, t_c = group.friction.friction_force(p, old, new, slide, curves)
    ahead = touches.along(t, slip, n)
    surface_friction.rub_probe(probe, t, ahead, d, t_k, t_c, nodes, scene)
    surface_friction.rub_face(p, hit, t, e, t_k, t_c, scene)
    surface_friction.note(h, p, totals, card, t, t_stored, t_loss, new)
    if old.active == 1:
        work.rub_along(old, past, count)
    work.rub_along(new, way, count)


@stage
def friction_on_shape(group, clock, h, touch, pressing, nodes, curves, scene):
    """Writes: scene.points, loads, totals, cards, new, nodes."""
    p, totals = group.p[0], group.totals[0]
    _, probe, x, v, old, new, hit, past = touch
    f, mass, way = pressing
    body = nodes[group.home[group.b[hit.face].node]]
    points = scene.points
    card, count = scene.cards[p.card], scene.card_history[1 - clock.current][p.card]
    d, y = surface_friction.on_shape(p, hit, x)
    a = surface_friction.probe_foretells(probe, d, old, points)
    v_a = surface_friction.probe_velocity(probe, v, d, h, nodes, points)
    v_b = node_contact.body_velocity(body, y)
    slip, n = surface_friction.slipping(v_a, v_b, hit, h, a)
    ease = 0.0
    if group.friction_damps:
        ahead = touches.ahead(old, slip, n)
        rates = surface_friction.pressed_on_shape(h, touch, body, (d, y), ahead, f, nodes, scene)
        ease = surface_friction.ease_under(clock, h, rates, f)
    slide = Slide(f, slip, work.along_plane(way, n), n, mass, ease)
    t, t_stored, _, t_loss, t_k, t_c = group.friction.friction_force(p, old, new, slide, curves)
    ahead = touches.along(t, slip, n)
    surface_friction.rub_probe(probe, t, ahead, d, t_k, t_c, nodes, scene)
    surface_friction.rub_body(body, y, t, ahead, t_k, t_c)
    surface_friction.note(h, p, totals, card, t, t_stored, t_loss, new)
    if old.active == 1:
        work.rub_along(old, past, count)
    work.rub_along(new, way, count)
