"""The point of b lies on the joint axis of a: two rows, Phi = ( side_a . d,  third_a . d )."""

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._constraint_rows import slide_along, slide_jacobian, slide_jacobian_rate

ANGULAR = (False, False)


@kernel
def residual(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[r].phi = slide_along(a, b, p.point_a, p.point_b, p.side_a)
    rows[r + 1].phi = slide_along(a, b, p.point_a, p.point_b, p.third_a)


@kernel
def jacobian(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    slide_jacobian(a, b, p.point_a, p.point_b, p.side_a, rows[r])
    slide_jacobian(a, b, p.point_a, p.point_b, p.third_a, rows[r + 1])


@kernel
def convective(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    rows[r].gamma = -slide_jacobian_rate(a, b, p.point_a, p.point_b, p.side_a)
    rows[r + 1].gamma = -slide_jacobian_rate(a, b, p.point_a, p.point_b, p.third_a)
