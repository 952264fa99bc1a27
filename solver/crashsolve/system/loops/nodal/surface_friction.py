"""Friction of one probe: on a face of a shell, and on a shape of a rigid body."""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.contact import node_contact, surface_friction, touches, work
from crashsolve.system.contact.pair import Slide


@stage
def friction_on_face(group, clock, h, touch, pressing, nodes, scene):
    """Writes: scene.points, loads, totals, cards, new."""
    p, f = group.p[0], pressing[0]
    _, probe, _, v, old, _, hit, _ = touch
    points, corners = scene.points, scene.corners
    d, e = work.arms(p, hit)
    a = surface_friction.predicted_probe_acceleration(probe, d, old, points)
    v_a = surface_friction.probe_velocity(probe, v, d, h, nodes, points)
    a = surface_friction.predicted_face_acceleration(p, hit, e, old, a, points, corners)
    v_b = surface_friction.face_velocity(p, hit, e, h, points, corners)
    slip, n = surface_friction.slip_velocity(v_a, v_b, hit, h, a)
    compliance = 0.0
    if group.friction_damps:
        ahead = touches.predicted_direction(old, slip, n)
        rates = surface_friction.pressed_on_face(h, p, touch, (d, e), ahead, f, nodes, scene)
        compliance = surface_friction.friction_compliance(clock, h, rates, f)
    t, _, t_k, t_c = friction_force(
        group, clock, h, touch, pressing, (slip, n, compliance, d), nodes, scene
    )
    surface_friction.add_friction_to_face(p, hit, t, e, t_k, t_c, scene)


@stage
def friction_on_shape(group, clock, h, touch, pressing, nodes, scene):
    """Writes: scene.points, loads, totals, cards, new, nodes."""
    p, f = group.p[0], pressing[0]
    _, probe, x, v, old, _, hit, _ = touch
    body = nodes[group.frame_bodies[group.b[hit.face].node]]
    points = scene.points
    d, y = surface_friction.position_on_shape(p, hit, x)
    a = surface_friction.predicted_probe_acceleration(probe, d, old, points)
    v_a = surface_friction.probe_velocity(probe, v, d, h, nodes, points)
    v_b = node_contact.body_velocity(body, y)
    slip, n = surface_friction.slip_velocity(v_a, v_b, hit, h, a)
    compliance = 0.0
    if group.friction_damps:
        ahead = touches.predicted_direction(old, slip, n)
        rates = surface_friction.pressed_on_shape(h, touch, body, (d, y), ahead, f, nodes, scene)
        compliance = surface_friction.friction_compliance(clock, h, rates, f)
    t, ahead, t_k, t_c = friction_force(
        group, clock, h, touch, pressing, (slip, n, compliance, d), nodes, scene
    )
    surface_friction.add_friction_to_body(body, y, t, ahead, t_k, t_c)


@kernel
def friction_force(group, clock, h, touch, pressing, sliding, nodes, scene):
    """Friction of a probe that slides with (velocity, normal, compliance, arm of the probe) on
    anything.

    Returns the force on the probe [N], its direction, and its stiffness and damping.
    Writes: scene.points, loads, totals, cards, new.
    """
    p, totals = group.p[0], group.totals[0]
    _, probe, _, _, old, new, _, old_displacement = touch
    (f, mass, displacement), (slip, n, compliance, d) = pressing, sliding
    card, count = scene.cards[p.card], scene.card_history[1 - clock.current][p.card]
    slide = Slide(f, slip, None, work.along_plane(displacement, n), n, mass, compliance)
    laws = group.friction.friction_force(p, old, new, slide, scene.curves)
    t, t_stored, _, t_loss, t_k, t_c = laws
    ahead = touches.unit_slip(t, slip, n)
    surface_friction.add_friction_to_probe(probe, t, ahead, d, t_k, t_c, nodes, scene)
    surface_friction.add_friction(h, p, totals, card, t, t_stored, t_loss, new)
    if old.active == 1:
        work.add_friction_work(old, old_displacement, count)
    work.add_friction_work(new, displacement, count)
    return t, ahead, t_k, t_c
