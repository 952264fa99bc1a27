"""The bodies do not rotate about the joint axis: one row, Phi = side_a . third_b."""

from crashsolve.foundation.kernels import kernel
from crashsolve.joints._constraint_rows import square_convective, square_jacobian, square_residual

ANGULAR = (True,)


@kernel
def residual(p, nodes, rows, r):
    """Writes: rows."""
    rows[r].phi = square_residual(p, p.side_a, p.third_b, nodes)


@kernel
def jacobian(p, nodes, rows, r):
    """Writes: rows."""
    square_jacobian(p, p.side_a, p.third_b, nodes, rows[r])


@kernel
def convective(p, nodes, rows, r):
    """Writes: rows."""
    rows[r].gamma = square_convective(p, p.side_a, p.third_b, nodes)
