"""A hinge that turns about one axis: revolute joint and moment over the angle.

    theta = theta_b - theta_a - theta_0 about the axis of a      (Ambrosio (2003), Eq. 6)

The angle is counted over any number of turns. `phi` grows with |theta_dot|, or with the speed of a
tip at some distance of the axis.
"""

from typing import Any

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_torque, spin_mobility, stiffen, turn_tangent
from crashsolve.foundation.record import Record
from crashsolve.foundation.turn import angle_about, angle_gradient, counted
from crashsolve.foundation.vec3 import dot, scale, sub, vec
from crashsolve.hinges._card import Motion, backbones, law, tip
from crashsolve.hinges._joint import (
    COMMON,
    LEDGER,
    at_start,
    close_outputs,
    fails,
    keep_old,
    let_go,
    motion_of,
)
from crashsolve.hinges._law import (
    LAW,
    PATH,
    advance_motion,
    beyond_motion,
    factor,
    growth_bound,
    growth_slope,
    motion_tangent,
    overshoot,
    step_factor,
)
from crashsolve.joints import revolute
from crashsolve.joints._card import FRAME
from crashsolve.joints.basic import rows_of

# what makes a file a hinge, but for its card
__all__ = ["ANGULAR", "CONSTRAINTS", "FREE", "HISTORY", "LEDGER", "OUTPUT", "PARAMETERS", "ROWS"]
__all__ += [
    "COUNTS_TURNS",
    "TANGENTS",
    "event",
    "build",
    "curves",
    "force",
    "initial_history",
    "let_go",
    "tangent",
]
CONSTRAINTS, FREE = revolute.CONSTRAINTS, revolute.FREE
ROWS, ANGULAR = rows_of(CONSTRAINTS)
TANGENTS = 1
COUNTS_TURNS = True
MOTIONS = (Motion("curve", "curve_negative", "stiffness", "initial_angle", "failure_angle"),)
PARAMETERS = FRAME + LAW + Record("tip  m or 1  speed of the factor over the rate")
HISTORY = PATH
OUTPUT = COMMON + Record("""
    moment          N m    positive turns b back
    angle           rad    of b from the undeformed hinge
    rate            rad/s  of the angle
    plastic_angle   rad    sum of plastic turns in both directions
    residual_angle  rad    that would be left without moment
""")


def curves(card: Any, built: dict[str, Any], scene: Any) -> dict[str, Any]:
    """Backbones by field."""
    return backbones(card, MOTIONS, built, scene)


def build(card: Any, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card)) | law(card, MOTIONS, scene) | {"tip": tip(card)}


def initial_history(card: Any, p: Any, scene: Any) -> dict[str, Any]:
    axis = scene.matrix(p["node_a"]) @ p["axis_a"]
    return at_start(p, p["tip"] * float(np.dot(axis, motion_of(scene, p)[1])))


@kernel
def turned(p, before, nodes):
    """Angle from the undeformed hinge, counted from `before`, its rate, and its gradient g."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    angle = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), before + p.initial[0])
    g = angle_gradient(a, b, p.axis_a, p.side_b)
    return angle - p.initial[0], dot(g, sub(vec(b.w), vec(a.w))), g


@kernel
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, rate, g = turned(p, old.x[0], nodes)
    keep_old(old, new)
    share = overshoot(p, old, 0, angle, curves) if p.latched == 1 else 2.0
    phi = factor(p, old, new, p.tip * abs(rate), share)
    new.failed = 1 if fails(p, old, angle, 0.0) else 0
    moment, stored, loss = 0.0, 0.0, 0.0
    if old.failed == 0:
        moment, stored, loss = advance_motion(p, old, new, 0, angle, phi, curves)
    if new.failed == 1:
        moment = 0.0
    new.x[0] = angle
    out.moment, out.angle, out.rate = moment, angle, rate
    out.plastic_angle, out.residual_angle = new.flow[0], new.plastic[0]
    close_outputs(p, old, new, out, stored, loss)
    a, b = nodes[p.node_a], nodes[p.node_b]
    apply_torque(a, scale(moment, g))
    apply_torque(b, scale(-moment, g))
    if new.failed == 0:
        drag = p.tip * growth_bound(p, new.speed) * abs(moment) / phi
        stiffen(a, spin_mobility(a, g), p.stiffness[0], drag)
        stiffen(b, spin_mobility(b, g), p.stiffness[0], drag)


@kernel
def tangent(p, state, nodes, curves, rows, first):
    """Writes: rows."""
    angle, rate, g = turned(p, state.x[0], nodes)
    stiffness, damping = 0.0, 0.0
    if state.failed == 0:
        speed = p.tip * abs(rate)
        phi, slope = step_factor(p, state, speed), growth_slope(p, speed)
        stiffness, damping, side = motion_tangent(p, state, 0, angle, rate, phi, slope, curves)
        damping = p.tip * damping if side * rate > 0.0 else 0.0
    turn_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], g, stiffness, damping)


@kernel
def event(p, old, h, nodes, curves):
    """How far this has left the branch of the law on which the step began [rad]."""
    if old.failed == 1:
        return -1e300
    angle, rate, _ = turned(p, old.x[0], nodes)
    phi = step_factor(p, old, p.tip * abs(rate))
    return max(beyond_motion(p, old, h, 0, angle, rate, phi, curves), abs(angle) - p.failure[0])
