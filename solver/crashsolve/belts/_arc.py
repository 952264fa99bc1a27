"""Part of a belt that lies on a body, or passes by it."""

from typing import NamedTuple

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import Vector, add_scaled, dot, norm, scale, sub

# of a belt that passes by: a share of it stays on either side of the surface, as a segment of no
# length has no strain
PASSING = 0.1
# sine of the angle between points opposite each other, as seen from the middle of a ball or an
# ellipsoid: no line over it is the shortest
OPPOSITE = 1e-9


class Arc(NamedTuple):
    """The part of a belt that lies on a body."""

    # 1, or 0 where it passes by; -1 where a point is within the shape, -2 where no line over it is
    # the shortest
    touches: int
    first: Vector  # points where it reaches the body, and leaves
    last: Vector
    middle: Vector  # of the arc, or the nearest point of the belt
    along: Vector  # its direction there
    length: float  # of the arc [m]
    bend: float  # integral of the curvature [rad]
    # about a cylinder, from the first point to the second [rad]; tau of an ellipsoid
    turned: float


@kernel
def straight_arc(touches, A, B, share, turned):
    """The Arc of a belt that is straight: its nearest point at a share of the line from A to B, or
    one beside it, where that is near an end; it divides webbing that moves without resistance.
    """
    line = sub(B, A)
    length = norm(line)
    middle = add_scaled(A, min(max(share, PASSING), 1.0 - PASSING), line)
    along = scale(1.0 / length, line) if length > 0.0 else (1.0, 0.0, 0.0)
    return Arc(touches, middle, middle, middle, along, 0.0, 0.0, turned)


@kernel
def nearest_share(A, B):
    """Share of the line from A to B at which it is nearest to the origin."""
    line = sub(B, A)
    square = dot(line, line)
    return -dot(A, line) / square if square > 0.0 else 0.0
