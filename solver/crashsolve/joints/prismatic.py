"""Prismatic joint (slider): b slides along one axis of a and does not turn against it.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b,  side_a . third_b ) = 0

with d = x_b - x_a. Consequence to test: one degree of freedom; b slides down an axis inclined by
alpha with g sin alpha.
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
    square_convective,
    square_jacobian,
    square_residual,
)

ROWS = 5
ANGULAR = (False, False, True, True, True)
FREE = ("travel",)
PARAMETERS = FRAME


class Prismatic(AxisJointCard):
    """Slider: b moves along one axis fixed in a and does not turn against a."""


def build(card: Prismatic, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    r = p.first_row
    line_residual(p, nodes, rows, r)
    parallel_residual(p, nodes, rows, r + 2)
    square_residual(p, p.side_a, p.third_b, nodes, rows[r + 4])


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    r = p.first_row
    line_jacobian(p, nodes, rows, r)
    parallel_jacobian(p, nodes, rows, r + 2)
    square_jacobian(p, p.side_a, p.third_b, nodes, rows[r + 4])


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    r = p.first_row
    line_convective(p, nodes, rows, r)
    parallel_convective(p, nodes, rows, r + 2)
    square_convective(p, p.side_a, p.third_b, nodes, rows[r + 4])
