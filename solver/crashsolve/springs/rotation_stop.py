"""Stops of the angle of a joint that has one, beyond which a spring and damper act.

    M = k e + c e_dot >= 0,   e = theta - upper, or lower - theta,   or M = f(e) + c e_dot

Consequence to test: without damping the joint rebounds with its speed after the time
pi sqrt(J / k); with the damping ratio zeta it rebounds with the restitution exp(-zeta omega t_c).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.angles import ROTATION_ABOUT_AXIS
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import put, scale
from crashsolve.springs import _joint
from crashsolve.springs._between import rotated

if TYPE_CHECKING:
    from crashsolve.springs._rows.rotation_stop import History, Output, Parameters

LEDGER = "joint"


class RotationStop(_joint.StopCard):
    """Stops of the angle of a joint, from its configuration at the start, or the zero posture."""

    curve_axes: ClassVar = {"curve": ("rad", "N m")}

    lower: float | None = quantity("rad", "angle of the lower stop; none when absent", default=None)
    upper: float | None = quantity("rad", "angle of the upper stop; none when absent", default=None)
    stiffness: float | None = quantity("N m/rad", "k, stiffness", default=None, gt=0)
    damping: float = quantity("N m s/rad", "c, damping", default=0.0, ge=0)


COUNTS_ROTATIONS = True
PARAMETERS = (
    ROTATION_ABOUT_AXIS + _joint.STOPS + Record("start  rad  angle at the start, of a posture")
)
HISTORY = _joint.STOPPED + Record("angle  rad  theta, over all revolutions")
TANGENTS = 1
OUTPUT = Record("""
    torque  N m    positive rotates b back
    angle   rad    of b from the start, or from the zero posture
    rate    rad/s  of the angle
    moment  N m    3  on b, axes of b
""")


def build(card: RotationStop, scene: Scene) -> Columns:
    frame = _joint.named_joint(scene, card.joint, "angle").frame
    start = scene.angles_at_start.get(card.joint, 0.0)
    columns = ROTATION_ABOUT_AXIS.columns_of(frame) | _joint.stops(card, scene) | {"start": start}
    placed = card.joint in scene.angles_at_start
    _joint.check_start(card, scene, columns, start, "rad", placed=placed)
    return columns


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, rate, g = rotated(p, old.angle, nodes)
    new.angle = angle
    out.angle = p.start + angle
    out.torque = _joint.stop(p, new, out.angle, rate, out, curves)
    out.rate = rate
    put(out.moment, matvec_t(nodes[p.node_b].A, scale(-out.torque, g)))
    # counted in the gap as well: nothing else shortens the step before the stop is met
    twist(p, nodes, out.torque, g, p.largest_slope, p.damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    angle, rate, g = rotated(p, state.angle, nodes)
    stiffness, damping = _joint.stop_tangent(p, p.start + angle, rate, curves)
    rotation_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], g, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance of the angle from the range in which it began the step, between the stops or
    beyond one [rad].
    """
    return _joint.stop_event(p, old, p.start + rotated(p, old.angle, nodes)[0])
