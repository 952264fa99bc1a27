"""Three-vectors as tuples, inside kernels (slices of arrays cost ten times as much)."""

from math import sqrt

from crashsolve.foundation.kernels import kernel

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)


@kernel
def unit(k):
    """Along axis k."""
    return (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)


@kernel
def vec(a):
    """Vector stored in a column of length 3."""
    return (a[0], a[1], a[2])


@kernel
def put(a, x):
    """Write vector x into a column. Writes: a."""
    a[0] = x[0]
    a[1] = x[1]
    a[2] = x[2]


@kernel
def triple(column, j):
    """Vector j of a column of vectors."""
    return (column[3 * j], column[3 * j + 1], column[3 * j + 2])


@kernel
def put_triple(column, j, x):
    """Writes: column."""
    column[3 * j], column[3 * j + 1], column[3 * j + 2] = x[0], x[1], x[2]


@kernel
def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def scale(s, a):
    return (s * a[0], s * a[1], s * a[2])


@kernel
def add_scaled(a, s, b):
    """a + s b."""
    return (a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2])


@kernel
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def norm(a):
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
