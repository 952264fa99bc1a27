"""The point of b lies on a plane of a, the joint axis its normal: one row, Phi = axis_a . d."""

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._constraint_rows import slide_along, slide_jacobian, slide_jacobian_rate

ANGULAR = (False,)


@kernel
def residual(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[r].phi = slide_along(a, b, p.point_a, p.point_b, p.axis_a)


@kernel
def jacobian(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[r])


@kernel
def convective(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[r].gamma = -slide_jacobian_rate(a, b, p.point_a, p.point_b, p.axis_a)
