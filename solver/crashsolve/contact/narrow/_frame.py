"""Directions between the world and the axes of a shape within a body."""

from crashsolve.foundation.columns import matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import place
from crashsolve.foundation.vec3 import sub, vec


@kernel
def into(shape, body, x):
    """World direction x in the axes of the shape."""
    return matvec_t(shape.axes, matvec_t(body.A, x))


@kernel
def out_of(shape, body, y):
    """Direction y in the axes of the shape, in the world."""
    return matvec(body.A, matvec(shape.axes, y))


@kernel
def seen_from(shape, body, x):
    """World point x from the centre of the shape, in its axes."""
    return into(shape, body, sub(x, place(body, vec(shape.point))))
