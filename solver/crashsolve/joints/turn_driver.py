"""Turn driver: the angle of a named joint follows a curve of time, over any number of turns.

    Phi = theta - ( f(t) - offset ),   nu = f'(t),   Phi_tt = -f''(t)

lambda is the driving torque on body b. Consequence to test: a disc driven by f = alpha t^2 / 2
needs the torque J alpha, and the driver's work is its kinetic energy.
"""

from typing import Any, ClassVar

from crashsolve.deck.card import JointName, word
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.turn import angle_about, angle_turning, counted
from crashsolve.joints._card import named_frame
from crashsolve.joints._driven import DrivenCard, motion
from crashsolve.joints._rows import turn_jacobian

COUNTS_TURNS = True
CONSTRAINTS = ()
ROWS = 1
ANGULAR = (True,)
CURVES_OF_TIME = ("curve",)
PARAMETERS = Record("""
    node_a  index     first body
    node_b  index     second body
    axis_a  1      3  joint axis, axes of a
    side_a  1      3  from which the angle counts, axes of a
    side_b  1      3  to which the angle counts, axes of b
    curve   index     f
    offset  rad       of f over the angle
""")
HISTORY = Record("angle  rad  theta, with all turns")


class TurnDriver(DrivenCard):
    """Prescribes the angle of a joint that has one; zero at the start."""

    curve_axes: ClassVar = {"curve": ("s", "rad")}

    joint: JointName = word("joint that has an angle: revolute, cylindrical, ...")


def build(card: TurnDriver, scene: Any) -> dict[str, Any]:
    frame = named_frame(scene, "joint", card.joint, "angle")
    columns = frame | motion(card, scene, 0.0, scene.deck.control.constraint_tolerance)
    return PARAMETERS.taken_from(columns)


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi, new."""
    angle = angle_about(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_a, p.side_b)
    new.angle = counted(angle, old.angle)
    f, _, _ = curve_value(curves, p.curve, t)
    rows[p.first_row].phi = new.angle - (f - p.offset)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    _, f_dot, _ = curve_value(curves, p.curve, t)
    turn_jacobian(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b, rows[p.first_row])
    rows[p.first_row].nu = f_dot


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    _, _, f_ddot = curve_value(curves, p.curve, t)
    turning = angle_turning(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b)
    rows[p.first_row].gamma = f_ddot - turning
