"""Friction against the rotation of a revolute, cylindrical or spherical joint; holds and slides.

    M = K z + c w while it holds,   |M| <= M_0 phi(t) + mu R |lambda|;   it slides at the limit

z is the elastic rotation of b against a since it last slid, R the radius of pin or ball and lambda
the force that presses the joint: all of it in a ball or hinge, that across the axis in a
cylindrical joint. It is the one expected from its course, right to second order in the step. With
phi(t) it is the brake of a wheel: M_0 is its torque at full pressure, and it locks at standstill.

Consequence to test: a disc with the speed w_0 stops after J w_0 / M_0; below the limit it stays for
ever. The energy lost is the work of M less the energy of the bristle.

Reference: Dahl (1968), A solid friction model, The Aerospace Corporation TOR-0158; journal friction
in joints: Haug, Wu and Yang (1986), Mechanism and Machine Theory 21, 401-406.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, JointName, quantity, word
from crashsolve.foundation.angles import orientation_in, rotation_between
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import add_stiffness_bound, apply_torque, arm, spin_mobility
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.springs._bristle import BRISTLE, PRESSING, friction_limit, lost, retained_share
from crashsolve.springs._joint import named_joint

if TYPE_CHECKING:
    from crashsolve.springs._rows.rotation_friction import History, Output, Parameters

LEDGER = "joint"


class RotationFriction(Card):
    """Friction against the rotation of a joint: a brake, a share of the reaction, or both."""

    curve_axes: ClassVar = {"torque_curve": ("s", "1")}

    joint: JointName = word("joint that has an angle, such as a revolute one, or a spherical joint")
    torque: float = quantity("N m", "constant part of the limit", default=0.0, ge=0)
    torque_curve: CurveName | None = word(
        "phi, factor on torque over time, as the pressure of a brake", default=None
    )
    friction_coefficient: float = quantity(
        "1", "mu, of the force that presses the joint", default=0.0, ge=0
    )
    radius: float | None = quantity(
        "m", "R of pin or ball; with friction_coefficient", default=None, gt=0
    )
    stiffness: float = quantity("N m/rad", "K, stiffness of the bristle", gt=0)
    damping: float = quantity("N m s/rad", "c, of the bristle", default=0.0, ge=0)

    @model_validator(mode="after")
    def _consistent(self) -> RotationFriction:
        if self.torque == 0.0 and self.friction_coefficient == 0.0:
            raise ValueError("needs torque, friction_coefficient or both")
        if self.torque_curve and self.torque == 0.0:
            raise ValueError("torque_curve: needs torque, on which it is a factor")
        if (self.friction_coefficient > 0.0) != (self.radius is not None):
            raise ValueError("friction_coefficient and radius belong together")
        return self


COUNTS_ROTATIONS = True
# the bristle is stretched by the slip of a whole step
STEPWISE = True
CURVES_OF_TIME = ("torque_curve",)
PARAMETERS = BRISTLE + Record("""
    node_a        index     first body
    node_b        index     second body
    axis_a        1      3  joint axis, axes of a; 0 for a ball
    torque_curve  index     phi over time; 0 for none
""")
HISTORY = PRESSING + Record("""
    configuration     1    4  quaternion of b in a
    bristle           rad  3  z, axes of a
    torque            N m  3  M, axes of a
    accumulated_slip  rad     sum of angles slid
""")
OUTPUT = Record("""
    torque            N m  3  on b, world axes
    moment            N m  3  the same, axes of b
    limit             N m     at which it slides
    accumulated_slip  rad     sum of angles slid
""")


def build(card: RotationFriction, scene: Scene) -> Columns:
    joint = named_joint(scene, card.joint, "angle", "ball")
    return {
        "level": card.torque,
        "torque_curve": scene.curve(card.torque_curve) if card.torque_curve else 0,
        "friction_coefficient": card.friction_coefficient * (card.radius or 0.0),
        "first_row": joint.first_row,
        "pressing": joint.angular.count(False),
        "stiffness": card.stiffness,
        "damping": card.damping,
        "node_a": joint.node_a,
        "node_b": joint.node_b,
        "axis_a": joint.frame.get("axis_a", (0.0, 0.0, 0.0)),
    }


def initial_history(card: RotationFriction, p: np.void, scene: Scene) -> Columns:
    w, x, y, z = scene.q[p["node_a"]]
    a = np.array([[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
    return {"configuration": a @ scene.q[p["node_b"]]}


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    now = orientation_in(a, b)
    before = (
        old.configuration[0],
        old.configuration[1],
        old.configuration[2],
        old.configuration[3],
    )
    rotation = rotation_between(before, now)
    trial = add(vec(old.bristle), rotation)
    limit = friction_limit(p, level(p, t, curves), old, new, h, rows)
    share = retained_share(p.stiffness, norm(trial), limit)
    z = scale(share, trial)
    w = matvec_t(a.A, sub(vec(b.w), vec(a.w)))
    torque = add_scaled(scale(p.stiffness, z), p.damping, w)
    if norm(torque) > limit:
        torque = scale(limit / norm(torque), torque)
    store_state(new, now, z, torque, old.accumulated_slip + (1.0 - share) * norm(trial))
    out.limit = limit
    out.accumulated_slip = new.accumulated_slip
    out.stored = 0.5 * p.stiffness * dot(z, z)
    out.power = 0.0
    was, bristle_torque = vec(old.bristle), vec(old.torque)
    out.loss = lost(p.stiffness, was, z, bristle_torque, torque, rotation) if h > 0.0 else 0.0
    put(out.torque, arm(a, scale(-1.0, torque)))
    put(out.moment, matvec_t(b.A, vec(out.torque)))
    apply_torque(b, vec(out.torque))
    apply_torque(a, scale(-1.0, vec(out.torque)))
    add_stiffness_bound(a, rotational_mobility(a, a, p), p.stiffness, p.damping)
    add_stiffness_bound(b, rotational_mobility(b, a, p), p.stiffness, p.damping)


@kernel
def level(p: Parameters, t, curves):
    """M_0 phi(t) [N m]; a negative factor releases the brake."""
    if p.torque_curve == 0:
        return p.level
    factor, _, _ = curve_value(curves, p.torque_curve, t)
    return p.level * max(factor, 0.0)


@kernel
def store_state(new: History, configuration, z, torque, slid):
    """Writes: new."""
    for k in range(4):
        new.configuration[k] = configuration[k]
    put(new.bristle, z)
    put(new.torque, torque)
    new.accumulated_slip = slid


@kernel
def rotational_mobility(body, a, p: Parameters):
    """Mobility about the axis of a [1/(kg m^2)]; an upper bound about any axis for a ball."""
    axis = vec(p.axis_a)
    if dot(axis, axis) > 0.0:
        return spin_mobility(body, arm(a, axis))
    return body.W[0] + body.W[4] + body.W[8]
