"""Revolute joint (hinge): the points coincide and b turns about one axis of a.

    Phi = ( x_b - x_a,  u_a . axis_b,  v_a . axis_b ) = 0      (Ambrosio (2003), Eq. 1)

u_a, v_a, axis_a are at right angles in body a. Consequence to test: one degree of freedom; a
pendulum on it has the period 4 K(sin(theta_0 / 2)) sqrt(L / g).
"""

from typing import Any

from crashsolve.joints._card import AxisJointCard
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._rows import (
    point_convective,
    point_jacobian,
    point_residual,
    square_convective,
    square_jacobian,
    square_residual,
)

ROWS = 5
ANGULAR = (False, False, False, True, True)


class Revolute(AxisJointCard):
    """Hinge: b turns about one axis fixed in a."""


PARAMETERS = Record(
    node_a=("index", "first body"),
    node_b=("index", "second body"),
    point_a=("m", 3, "joint point from the mass centre of a, axes of a"),
    point_b=("m", 3, "joint point from the mass centre of b, axes of b"),
    axis_a=("1", 3, "joint axis, axes of a"),
    side_a=("1", 3, "at right angles to the axis, axes of a"),
    third_a=("1", 3, "axis x side, axes of a"),
    axis_b=("1", 3, "joint axis, axes of b"),
    side_b=("1", 3, "side at the start, axes of b"),
    third_b=("1", 3, "third at the start, axes of b"),
)


def build(card: Revolute, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    r = p.first_row
    point_residual(p, nodes, rows, r)
    square_residual(p, p.side_a, p.axis_b, nodes, rows[r + 3])
    square_residual(p, p.third_a, p.axis_b, nodes, rows[r + 4])


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    r = p.first_row
    point_jacobian(p, nodes, rows, r)
    square_jacobian(p, p.side_a, p.axis_b, nodes, rows[r + 3])
    square_jacobian(p, p.third_a, p.axis_b, nodes, rows[r + 4])


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    r = p.first_row
    point_convective(p, nodes, rows, r)
    square_convective(p, p.side_a, p.axis_b, nodes, rows[r + 3])
    square_convective(p, p.third_a, p.axis_b, nodes, rows[r + 4])
