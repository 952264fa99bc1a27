"""The joint axes are parallel: two rows, Phi = ( side_a . axis_b,  third_a . axis_b )."""

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._constraint_rows import square_convective, square_jacobian, square_residual

ANGULAR = (True, True)


@kernel
def residual(p, nodes, rows, r):
    """Writes: rows."""
    rows[r].phi = square_residual(p, p.side_a, p.axis_b, nodes)
    rows[r + 1].phi = square_residual(p, p.third_a, p.axis_b, nodes)


@kernel
def jacobian(p, nodes, rows, r):
    """Writes: rows."""
    square_jacobian(p, p.side_a, p.axis_b, nodes, rows[r])
    square_jacobian(p, p.third_a, p.axis_b, nodes, rows[r + 1])


@kernel
def convective(p, nodes, rows, r):
    """Writes: rows."""
    rows[r].gamma = square_convective(p, p.side_a, p.axis_b, nodes)
    rows[r + 1].gamma = square_convective(p, p.third_a, p.axis_b, nodes)
