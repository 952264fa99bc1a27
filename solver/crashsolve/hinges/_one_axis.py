"""A hinge that rotates about one axis: revolute joint and moment over the angle.

    theta = theta_b - theta_a - theta_0 about the axis of a      (Ambrosio (2003), Eq. 6)

The angle is counted over any number of revolutions. `phi` grows with |theta_dot|, or with the speed
of a tip at some distance of the axis.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card
from crashsolve.foundation.angles import angle_about, angle_gradient, counted
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, sub, vec
from crashsolve.hinges import _single
from crashsolve.hinges._card import Motion, RotationalCard, backbones, law, rate_arm
from crashsolve.hinges._joint import COMMON, LEDGER, at_start, motion_of, release_rows
from crashsolve.hinges._law import LAW, PATH, growth_bound
from crashsolve.joints import revolute
from crashsolve.joints._card import FRAME
from crashsolve.joints.basic import rows_of

if TYPE_CHECKING:
    from crashsolve.hinges._rows._one_axis import History, Output, Parameters

# the functions of a hinge, without its card
__all__ = ["ANGULAR", "CONSTRAINTS", "FREE", "HISTORY", "LEDGER", "OUTPUT", "PARAMETERS", "ROWS"]
__all__ += [
    "COUNTS_ROTATIONS",
    "TANGENTS",
    "event",
    "build",
    "curves",
    "force",
    "initial_history",
    "release_rows",
    "tangent",
]
CONSTRAINTS, FREE = revolute.CONSTRAINTS, revolute.FREE
ROWS, ANGULAR = rows_of(CONSTRAINTS)
TANGENTS = 1
COUNTS_ROTATIONS = True
MOTIONS = (Motion("curve", "curve_negative", "stiffness", "initial_angle", "failure_angle"),)
curves = partial(backbones, MOTIONS)
PARAMETERS = FRAME + LAW + Record("rate_arm  m or 1  speed of the factor over the rate")
HISTORY = PATH
OUTPUT = COMMON + Record("""
    moment          N m    positive rotates b back
    angle           rad    of b from the undeformed hinge
    rate            rad/s  of the angle
    plastic_angle   rad    sum of plastic rotations in both directions
    residual_angle  rad    that would be left without moment
""")


def build(card: RotationalCard, scene: Scene) -> Columns:
    return dict(scene.joint_frame(card)) | law(card, MOTIONS, scene) | {"rate_arm": rate_arm(card)}


def initial_history(card: Card, p: np.void, scene: Scene) -> Columns:
    axis = scene.matrix(p["node_a"]) @ p["axis_a"]
    return at_start(p, p["rate_arm"] * float(np.dot(axis, motion_of(scene, p)[1])))


@kernel
def rotated(p, before, nodes):
    """Angle from the undeformed hinge [rad], counted from `before`, its rate, its gradient g."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    angle = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), before + p.initial[0])
    g = angle_gradient(a, b, p.axis_a, p.side_b)
    return angle - p.initial[0], dot(g, sub(vec(b.w), vec(a.w))), g


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, rate, g = rotated(p, old.x[0], nodes)
    moment, phi = _single.response(p, old, new, out, angle, p.rate_arm * abs(rate), curves)
    out.moment, out.angle, out.rate = moment, angle, rate
    out.plastic_angle, out.residual_angle = new.flow[0], new.plastic[0]
    if new.failed == 0:
        drag = p.rate_arm * growth_bound(p, new.speed) * abs(moment) / phi
        twist(p, nodes, moment, g, p.stiffness[0], drag)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    angle, rate, g = rotated(p, state.x[0], nodes)
    stiffness, damping = _single.slopes(p, state, angle, rate, p.rate_arm * abs(rate), curves)
    a, b = nodes[p.node_a], nodes[p.node_b]
    rotation_tangent(rows[first], a, b, g, stiffness, p.rate_arm * damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [rad]."""
    angle, rate, _ = rotated(p, old.x[0], nodes)
    return _single.beyond(p, old, h, angle, rate, p.rate_arm * abs(rate), curves)
