"""Drive torque between the two bodies of a joint, constant or by a curve of time.

    M = T phi(t) g on b, and -M on a;   theta_dot = g . (w_b - w_a),   power T phi theta_dot

It is the torque of an engine or of a driver's hands: the torque that turns b forward turns the
housing a back, and nothing comes from outside. Consequence to test: with a flywheel J_e behind a
gear of ratio n, a wheel J_w takes T n / (J_w + n^2 J_e) from the torque T on the flywheel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, JointName, quantity, word
from crashsolve.foundation.angles import angle_gradient
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_torque
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import dot, put, scale, sub, vec

if TYPE_CHECKING:
    from crashsolve.loads._rows.drive_torque import History, Output, Parameters


class DriveTorque(Card):
    """Torque between the two bodies of a joint that has an angle."""

    curve_axes: ClassVar = {"curve": ("s", "1")}

    joint: JointName = word("joint that has an angle: revolute, cylindrical, ...")
    torque: float = quantity("N m", "T, on the second body of the joint about its axis")
    curve: CurveName | None = word("phi, factor over time; 1 when absent", default=None)


CURVES_OF_TIME = ("curve",)
PARAMETERS = Record("""
    node_a  index     first body of the joint
    node_b  index     second body
    axis_a  1      3  axis, axes of a
    side_b  1      3  at right angles to the axis at the start, axes of b
    torque  N m       T
    curve   index     phi over time; 0 for none
""")
AMPLITUDE = "torque"
HISTORY = Record()
OUTPUT = Record("""
    torque  N m    on b about the axis
    rate    rad/s  of the angle
    moment  N m    3  on b, world axes
""")


def build(card: DriveTorque, scene: Scene) -> Columns:
    scene.refuse_joint(card.joint, ("angle",), "joint")
    frame = scene.joints[card.joint].frame
    return {
        "node_a": frame["node_a"],
        "node_b": frame["node_b"],
        "axis_a": frame["axis_a"],
        "side_b": frame["side_b"],
        "torque": card.torque,
        "curve": scene.curve(card.curve) if card.curve else 0,
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    factor = 1.0
    if p.curve > 0:
        factor, _, _ = curve_value(curves, p.curve, t)
    g = angle_gradient(a, b, p.axis_a, p.side_b)
    out.torque = p.torque * factor
    out.rate = dot(g, sub(vec(b.w), vec(a.w)))
    put(out.moment, scale(out.torque, g))
    apply_torque(b, vec(out.moment))
    apply_torque(a, scale(-1.0, vec(out.moment)))
    out.stored = 0.0
    out.power = out.torque * out.rate
    out.loss = 0.0
