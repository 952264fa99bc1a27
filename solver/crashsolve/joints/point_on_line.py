"""Point on line: a point of b stays on a line of a.

    Phi = ( side_a . d,  third_a . d ) = 0,   d = x_b - x_a

Consequence to test: four degrees of freedom; the ends of a ladder on a wall and a floor.
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._rows import line_convective, line_jacobian, line_residual

ROWS = 2
ANGULAR = (False, False)
PARAMETERS = FRAME


class PointOnLine(AxisJointCard):
    """The point `at` of b stays on the line through `at` along `axis` of a."""


def build(card: PointOnLine, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    line_residual(p, nodes, rows, p.first_row)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    line_jacobian(p, nodes, rows, p.first_row)


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    line_convective(p, nodes, rows, p.first_row)
