"""Friction of one contact pair: of its slip, or of its slip and its spin together.

In steps of kicks, friction that damps near rest stops a slip at most, and limits steps only by the
change of the slip (friction/_regularised.py); any other friction limits them by its stiffness.
"""

from crashsolve.foundation.kernels import stage
from crashsolve.system.contact import areas, touches, work
from crashsolve.system.contact.pair import Slide
from crashsolve.system.loops.mobilities import friction_mobility, pair_mobility
from crashsolve.system.placeholders import KICK_DRIFT_KICK


@stage
def friction_in_point(group, clock, h, pair, totals, sliding, curves):
    """Friction against the slip: force, power, loss without a rate. Writes: new, out, totals."""
    p, old, new, out, m, w = pair.p, pair.old, pair.new, pair.out, pair.a, pair.b
    n, slip, displacement, f, mass, d_a, d_b = sliding
    compliance = 0.0
    if KICK_DRIFT_KICK and group.friction_damps:
        u = touches.predicted_direction(old, slip, n)
        mob_t, mob_u = pair_mobility(m, w, d_a, d_b, u)
        compliance = touches.friction_compliance(clock, h, pair, totals, mob_t, mob_u, f)
    slid = work.along_plane(displacement, n) if KICK_DRIFT_KICK else None
    middle = work.mean_velocity(h, slid, slip) if KICK_DRIFT_KICK else None
    slide = Slide(f, slip, middle, slid, n, mass, compliance)
    t, out.friction_stored, power, loss, t_k, t_c = group.friction.friction_force(
        p, old, new, slide, curves
    )
    if KICK_DRIFT_KICK and group.friction_damps:
        touches.bound_slip(totals, group.friction.slip_rate(p, slide, h))
    else:
        u = touches.unit_slip(t, slip, n)
        mob_t, mob_u = pair_mobility(m, w, d_a, d_b, u)
        touches.add_pair_stiffness(totals.on_a, totals.on_b, mob_t, mob_u, t_k, t_c)
    return t, power, loss


@stage
def friction_in_area(group, clock, h, pair, totals, sliding, motion, radius, curves):
    """Friction against slip and spin, their displacements; power, loss.

    Writes: new, out, totals.
    """
    p, old, new, out, m, w = pair.p, pair.old, pair.new, pair.out, pair.a, pair.b
    n, slip, displacement, f, mass, d_a, d_b = sliding
    slip = areas.combined_slip(m, w, slip, n, radius)
    compliance = 0.0
    sliding_displacement = (
        areas.sliding_displacement(motion, displacement, n, radius) if KICK_DRIFT_KICK else None
    )
    if KICK_DRIFT_KICK and group.friction_damps:
        u = touches.predicted_direction(old, slip, n)
        mob_t, mob_u = friction_mobility(m, w, d_a, d_b, u, n, radius)
        compliance = touches.friction_compliance(clock, h, pair, totals, mob_t, mob_u, f)
    middle = work.mean_velocity(h, sliding_displacement, slip) if KICK_DRIFT_KICK else None
    slide = Slide(f, slip, middle, sliding_displacement, areas.NO_ROTATION, mass, compliance)
    friction_force, out.friction_stored, power, loss, t_k, t_c = group.friction.friction_force(
        p, old, new, slide, curves
    )
    if KICK_DRIFT_KICK and group.friction_damps:
        touches.bound_slip(totals, group.friction.slip_rate(p, slide, h))
    else:
        u = touches.unit_slip(friction_force, slip, n)
        mob_t, mob_u = friction_mobility(m, w, d_a, d_b, u, n, radius)
        touches.add_pair_stiffness(totals.on_a, totals.on_b, mob_t, mob_u, t_k, t_c)
    return friction_force, sliding_displacement, power, loss
