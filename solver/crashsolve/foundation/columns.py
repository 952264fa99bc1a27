"""Columns of tables that hold vectors and matrices: sums and products."""

from crashsolve.foundation.kernels import inlined, kernel


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


@inlined
def symmetric_matvec(C, x):
    """Product of a symmetric 3 x 3 matrix, by the rows of its upper half (6), with x."""
    return (
        C[0] * x[0] + C[1] * x[1] + C[2] * x[2],
        C[1] * x[0] + C[3] * x[1] + C[4] * x[2],
        C[2] * x[0] + C[4] * x[1] + C[5] * x[2],
    )
