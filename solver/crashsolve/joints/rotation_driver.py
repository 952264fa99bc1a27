"""Rotation driver: the angle of a named joint follows a curve of time, over all revolutions.

    Phi = theta - x(t),   nu = x'(t),   Phi_tt = -x''(t)     (x: _driven.py)

lambda is the driving torque on body b. Consequence to test: a disc driven by f = alpha t^2 / 2
needs the torque J alpha, and the driver's work is its kinetic energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import JointName, word
from crashsolve.foundation.angles import angle_about, angle_jacobian_rate, counted
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import named_frame
from crashsolve.joints._constraint_rows import rotation_jacobian
from crashsolve.joints._driven import MOTION, DrivenCard, driven, motion

if TYPE_CHECKING:
    from crashsolve.joints._rows.rotation_driver import History, Parameters

COUNTS_ROTATIONS = True
CONSTRAINTS = ()
ROWS = 1
ANGULAR = (True,)
CURVES_OF_TIME = ("curve",)
PARAMETERS = (
    Record("""
    node_a  index     first body
    node_b  index     second body
    axis_a  1      3  joint axis, axes of a
    side_a  1      3  from which the angle counts, axes of a
    side_b  1      3  to which the angle counts, axes of b
""")
    + MOTION
)
HISTORY = Record("angle  rad  theta, over all revolutions")


class RotationDriver(DrivenCard):
    """Prescribes the angle of a joint that has one; zero at the start."""

    curve_axes: ClassVar = {
        "curve": ("s", "rad"),
        "velocity": ("s", "rad/s"),
        "acceleration": ("s", "rad/s^2"),
    }

    joint: JointName = word("joint that has an angle: revolute, cylindrical, ...")


def build(card: RotationDriver, scene: Scene) -> Columns:
    frame = named_frame(scene, "joint", card.joint, "angle")
    columns = frame | motion(
        card, scene, 0.0, rotation_rate(frame, scene), scene.deck.control.constraint_tolerance
    )
    return PARAMETERS.columns_of(columns)


def rotation_rate(frame: Columns, scene: Scene) -> float:
    """Rate of the angle at the start [rad/s]."""
    a, b = frame["node_a"], frame["node_b"]
    return float(scene.matrix(a) @ frame["axis_a"] @ (scene.w[b] - scene.w[a]))


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi, new."""
    angle = angle_about(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_a, p.side_b)
    new.angle = counted(angle, old.angle)
    x, _, _ = driven(p, curves, t)
    rows[p.first_row].phi = new.angle - x


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    _, x_dot, _ = driven(p, curves, t)
    rotation_jacobian(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b, rows[p.first_row])
    rows[p.first_row].nu = x_dot


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    _, _, x_ddot = driven(p, curves, t)
    convective = angle_jacobian_rate(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b)
    rows[p.first_row].gamma = x_ddot - convective
