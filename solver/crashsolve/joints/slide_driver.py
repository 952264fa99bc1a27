"""Slide driver: the travel of b along the axis of a named joint follows a curve of time.

    Phi = axis_a . (x_b - x_a) - ( f(t) - offset ),   nu = f'(t),   Phi_tt = -f''(t)

lambda is the driving force on body b. Consequence to test: a mass driven by f = A sin(omega t)
needs the force -m A omega^2 sin(omega t).
"""

from typing import Any, ClassVar

from crashsolve.deck.card import JointName, word
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS, named_frame
from crashsolve.joints._driven import DrivenCard, motion
from crashsolve.joints._rows import slide_along, slide_jacobian, slide_turning

CONSTRAINTS = ()
ROWS = 1
ANGULAR = (False,)
CURVES_OF_TIME = ("curve",)
PARAMETERS = POINTS + Record("""
    axis_a  1      3  joint axis, axes of a
    curve   index     f
    offset  m         of f over the travel
""")


class SlideDriver(DrivenCard):
    """Prescribes the travel of a joint that has one; zero at the start."""

    curve_axes: ClassVar = {"curve": ("s", "m")}

    joint: JointName = word("joint that has a travel: prismatic, cylindrical, ...")


def build(card: SlideDriver, scene: Any) -> dict[str, Any]:
    frame = named_frame(scene, "joint", card.joint, "travel")
    tolerance = scene.deck.control.constraint_tolerance * scene.size
    columns = frame | motion(card, scene, 0.0, tolerance)
    return PARAMETERS.taken_from(columns)


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    f, _, _ = curve_value(curves, p.curve, t)
    travel = slide_along(a, b, p.point_a, p.point_b, p.axis_a)
    rows[p.first_row].phi = travel - (f - p.offset)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    _, f_dot, _ = curve_value(curves, p.curve, t)
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[p.first_row])
    rows[p.first_row].nu = f_dot


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    _, _, f_ddot = curve_value(curves, p.curve, t)
    turning = slide_turning(a, b, p.point_a, p.point_b, p.axis_a)
    rows[p.first_row].gamma = f_ddot - turning
