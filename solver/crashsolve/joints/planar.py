"""Planar joint: a plane of b slides on a plane of a; the joint axis is their normal.

    Phi = ( axis_a . (x_b - x_a),  side_a . axis_b,  third_a . axis_b ) = 0

Consequence to test: three degrees of freedom; on a level plane the mass centre runs straight with
constant speed while the body keeps its spin.
"""

from typing import Any

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints._rows import (
    parallel_convective,
    parallel_jacobian,
    parallel_residual,
    slide_along,
    slide_jacobian,
    slide_turning,
)

ROWS = 3
ANGULAR = (False, True, True)
FREE = ("angle",)
PARAMETERS = FRAME


class Planar(AxisJointCard):
    """b slides and turns on a plane fixed in a; `axis` is the plane's normal."""


def build(card: Planar, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))


@kernel
def residual(p, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    rows[r].phi = slide_along(a, b, p.point_a, p.point_b, p.axis_a)
    parallel_residual(p, nodes, rows, r + 1)


@kernel
def jacobian(p, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[r])
    parallel_jacobian(p, nodes, rows, r + 1)


@kernel
def convective(p, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b, r = nodes[p.node_a], nodes[p.node_b], p.first_row
    rows[r].gamma = -slide_turning(a, b, p.point_a, p.point_b, p.axis_a)
    parallel_convective(p, nodes, rows, r + 1)
