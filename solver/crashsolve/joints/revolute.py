"""Revolute joint (hinge): the points coincide and b turns about one axis of a.

    Phi = ( x_b - x_a,  side_a . axis_b,  third_a . axis_b ) = 0      (Ambrosio (2003), Eq. 1)

side_a, third_a, axis_a are at right angles in body a. Consequence to test: one degree of freedom;
a pendulum on it has the period 4 K(sin(theta_0 / 2)) sqrt(L / g).
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._rows import (
    parallel_convective,
    parallel_jacobian,
    parallel_residual,
    point_convective,
    point_jacobian,
    point_residual,
)

ROWS = 5
ANGULAR = (False, False, False, True, True)
FREE = ("angle",)
PARAMETERS = FRAME


class Revolute(AxisJointCard):
    """Hinge: b turns about one axis fixed in a."""


def build(card: Revolute, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    point_residual(p, nodes, rows, p.first_row)
    parallel_residual(p, nodes, rows, p.first_row + 3)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    point_jacobian(p, nodes, rows, p.first_row)
    parallel_jacobian(p, nodes, rows, p.first_row + 3)


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    point_convective(p, nodes, rows, p.first_row)
    parallel_convective(p, nodes, rows, p.first_row + 3)
