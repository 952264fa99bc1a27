"""Range of the twist of b about its own axis, apart from its swing.

    tau = 2 atan2(q_z, q_w),   q the rotation of (side_b, third_b, pointer) in (side_a, third_a,
    axis) tau_dot = g . (w_b - w_a),   g = (c + s) / (1 + c . s)
    counted over whole revolutions: of all its values the one next to that of the last step

tau is the rotation of b against a that remains when the pointer s has been brought back to c on
the shortest path, so that a swing in any direction has no twist. The moment past `lower` or `upper`
is that of `_range.py`. Consequence to test: g is the derivative of tau at any swing below half a
turn.

Reference: Baerlocher and Boulic (2001), Parametrization and range of motion of the ball-and-socket
joint, Deformable Avatars, IFIP 68, 180-190.
"""

from __future__ import annotations

from math import atan2, sqrt
from typing import TYPE_CHECKING

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity, word
from crashsolve.foundation.angles import FOLDED, check_rotation_limit, counted
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, dot, put, scale, sub, vec
from crashsolve.springs._joint import named_joint
from crashsolve.springs._range import (
    AT_LIMIT,
    LARGEST,
    MOMENT,
    REACHED,
    RangeCard,
    moment_columns,
    range_event,
    range_moment,
    range_tangent,
)

if TYPE_CHECKING:
    from crashsolve.springs._rows.twist_stop import History, Output, Parameters

LEDGER = "joint"
COUNTS_ROTATIONS = True


class TwistStop(RangeCard):
    """Range of the twist of a spherical joint about the axis of its second body."""

    axis: Vec3 = word("axis without swing, in the frame of a; any length")
    toward: Vec3 = word("direction of twist 0, in the frame of a; any that is not along the axis")
    pointer: Vec3 = word("axis of the twist, in the frame of b; any length")
    toward_b: Vec3 = word("direction that points along `toward` without twist, in the frame of b")
    lower: float = quantity("rad", "lower end of the range", ge=-LARGEST, le=LARGEST)
    upper: float = quantity("rad", "upper end of the range", ge=-LARGEST, le=LARGEST)

    @model_validator(mode="after")
    def _in_order(self) -> TwistStop:
        if self.lower >= self.upper:
            raise ValueError("lower: must be below upper")
        return self


PARAMETERS = MOMENT + Record("""
    node_a   index     first body
    node_b   index     second body
    axis_a   1      3  c, axes of a
    side_a   1      3  direction of twist 0, axes of a
    axis_b   1      3  s, axes of b
    side_b   1      3  the same direction without twist, axes of b
    lower    rad       end of the range
    upper    rad       end of the range
""")
HISTORY = REACHED + Record("angle  rad  tau, over all revolutions")
TANGENTS = 1
OUTPUT = Record("""
    torque  N m  M, positive rotates b back
    angle   rad  tau, over all revolutions
    margin  rad  to the nearer limit; negative past it
    energy  J    stored
    moment  N m  3  on b, axes of b
""")


def build(card: TwistStop, scene: Scene) -> Columns:
    joint = named_joint(scene, card.joint, "ball")
    columns = moment_columns(card, scene, "both") | {
        "node_a": joint.node_a,
        "node_b": joint.node_b,
        "lower": card.lower,
        "upper": card.upper,
    }
    for body, axis, toward in (("a", "axis", "toward"), ("b", "pointer", "toward_b")):
        u = scene.unit(getattr(card, axis), axis)
        side = scene.unit(getattr(card, toward), toward)
        side = side - (side @ u) * u
        if np.linalg.norm(side) < 1e-6:
            raise scene.fail(f"must not be along {axis}, about which the twist is", toward)
        columns[f"axis_{body}"], columns[f"side_{body}"] = u, scene.unit(side, toward)
    _check_start(card, scene, columns)
    return columns


def _check_start(card: TwistStop, scene: Scene, p: Columns) -> None:
    """A joint that begins past its range would be kicked back into it."""
    A_a, A_b = scene.matrix(p["node_a"]), scene.matrix(p["node_b"])
    vectors = (A_a @ p["axis_a"], A_a @ p["side_a"], A_b @ p["axis_b"], A_b @ p["side_b"])
    swing = float(np.arccos(np.clip(vectors[0] @ vectors[2], -1.0, 1.0)))
    if swing > FOLDED:
        raise scene.fail(
            f"'{card.joint}' begins with axis and pointer {swing:.4g} rad apart, where a twist is "
            "not defined; keep them within 3 rad: rotate a body, or reverse the pointer",
            "joint",
        )
    tau = twist_angle(*(tuple(map(float, v)) for v in vectors))
    past = max(tau - card.upper, card.lower - tau)
    if past > AT_LIMIT:
        raise scene.fail(
            f"'{card.joint}' begins at the twist {tau:.4g} rad, {past:.3g} rad past its range from "
            f"{card.lower:.4g} to {card.upper:.4g} rad; rotate a body, or widen the range",
            "joint",
        )


@kernel
def twist_angle(c, x, s, y):
    """tau [rad] of axes c and s with the sides x and y, world components; in (-pi, pi]."""
    # y brought back by the shortest rotation of s to c
    back = cross(s, c)
    cosine = dot(s, c)
    along = dot(back, y) / (1.0 + cosine)
    rotated = add(add(scale(cosine, y), cross(back, y)), scale(along, back))
    return atan2(dot(rotated, cross(c, x)), dot(rotated, x))


@kernel
def twist_of(p: Parameters, before, nodes):
    """tau [rad], counted from `before`, its gradient g over rotations of b, and the cosine of the
    swing.
    """
    a, b = nodes[p.node_a], nodes[p.node_b]
    c, x = arm(a, vec(p.axis_a)), arm(a, vec(p.side_a))
    s, y = arm(b, vec(p.axis_b)), arm(b, vec(p.side_b))
    cosine = max(dot(c, s), -0.9999)
    angle = counted(twist_angle(c, x, s, y), before)
    return angle, scale(1.0 / (1.0 + cosine), add(c, s)), cosine


@kernel
def past_range(p: Parameters, angle):
    """Angle past an end of the range, of its sign; 0 within [rad]."""
    return max(angle - p.upper, 0.0) - max(p.lower - angle, 0.0)


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, g, cosine = twist_of(p, old.angle, nodes)
    new.angle = angle
    check_rotation_limit(curves, p.node_b, sqrt(max(0.5 + 0.5 * cosine, 0.0)))
    rate = dot(g, sub(vec(nodes[p.node_b].w), vec(nodes[p.node_a].w)))
    out.torque = range_moment(p, old, new, out, h, past_range(p, angle), rate, curves)
    out.angle, out.margin = angle, min(p.upper - angle, angle - p.lower)
    out.energy = out.stored
    put(out.moment, matvec_t(nodes[p.node_b].A, scale(-out.torque, g)))
    # a moment along g has a stiffness of its own, as the swing rotates g: |dg| <= rotation |g|^2
    rotation = 0.5 * (1.0 + sqrt(2.0 * max(1.0 - cosine, 0.0)))
    stiffness = p.largest_slope + rotation * abs(out.torque)
    twist(p, nodes, out.torque, g, stiffness, p.stop_damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    angle, g, _ = twist_of(p, state.angle, nodes)
    rate = dot(g, sub(vec(b.w), vec(a.w)))
    stiffness, damping = range_tangent(p, state, past_range(p, angle), rate, curves)
    rotation_tangent(rows[first], a, b, g, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance of the twist from the range in which it began the step, in its range or past it
    [rad].
    """
    angle, g, _ = twist_of(p, old.angle, nodes)
    rate = dot(g, sub(vec(nodes[p.node_b].w), vec(nodes[p.node_a].w)))
    upper = 2.0 * angle > p.upper + p.lower
    past = angle - p.upper if upper else p.lower - angle
    return range_event(p, old, h, past, rate if upper else -rate, curves)
