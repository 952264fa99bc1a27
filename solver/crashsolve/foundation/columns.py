"""Columns of tables that hold vectors and matrices: sums and products."""

from crashsolve.foundation.kernels import kernel


@kernel
def add_to(a, x):
    """Add vector x to a column. Writes: a."""
    a[0] += x[0]
    a[1] += x[1]
    a[2] += x[2]


@kernel
def matvec(m, x):
    """Product of a 3 x 3 matrix, a column of length 9 stored by rows, with x."""
    return (
        m[0] * x[0] + m[1] * x[1] + m[2] * x[2],
        m[3] * x[0] + m[4] * x[1] + m[5] * x[2],
        m[6] * x[0] + m[7] * x[1] + m[8] * x[2],
    )


@kernel
def matvec_t(m, x):
    """Product of the transposed matrix with x."""
    return (
        m[0] * x[0] + m[3] * x[1] + m[6] * x[2],
        m[1] * x[0] + m[4] * x[1] + m[7] * x[2],
        m[2] * x[0] + m[5] * x[1] + m[8] * x[2],
    )
