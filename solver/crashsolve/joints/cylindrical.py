"""Cylindrical joint: b turns about and slides along one axis of a.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b ) = 0,   d = x_b - x_a

Consequence to test: two degrees of freedom that know nothing of each other: b falls along an
upright axis with g while it keeps its spin.
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._rows import (
    line_convective,
    line_jacobian,
    line_residual,
    parallel_convective,
    parallel_jacobian,
    parallel_residual,
)

ROWS = 4
ANGULAR = (False, False, True, True)
FREE = ("angle", "travel")
PARAMETERS = FRAME


class Cylindrical(AxisJointCard):
    """Sleeve on a shaft: b turns about and slides along one axis fixed in a."""


def build(card: Cylindrical, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    line_residual(p, nodes, rows, p.first_row)
    parallel_residual(p, nodes, rows, p.first_row + 2)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    line_jacobian(p, nodes, rows, p.first_row)
    parallel_jacobian(p, nodes, rows, p.first_row + 2)


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    line_convective(p, nodes, rows, p.first_row)
    parallel_convective(p, nodes, rows, p.first_row + 2)
