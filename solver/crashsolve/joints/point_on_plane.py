"""Point on plane: a point of b stays on a plane of a; the axis is the plane's normal.

    Phi = axis_a . (x_b - x_a) = 0

Consequence to test: five degrees of freedom; a ladder on a smooth wall and floor.
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._rows import slide_along, slide_jacobian, slide_turning

ROWS = 1
ANGULAR = (False,)
PARAMETERS = FRAME


class PointOnPlane(AxisJointCard):
    """The point `at` of b stays on the plane of a through `at` with the normal `axis`."""


def build(card: PointOnPlane, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[p.first_row].phi = slide_along(a, b, p.point_a, p.point_b, p.axis_a)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[p.first_row])


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[p.first_row].gamma = -slide_turning(a, b, p.point_a, p.point_b, p.axis_a)
