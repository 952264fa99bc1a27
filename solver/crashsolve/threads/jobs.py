"""Jobs that threads share, and the sums of their pieces."""

from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import load_point
from crashsolve.foundation.vec3 import put, vec

NONE, OPEN, DEFORM, LOAD, COLLECT, CLOSE, SPEED, SEARCH, PAIR_FORCES, BODY_LOADS, APPROACH = range(
    11
)


@kernel
def collect_replicas(piece, scene):
    """Add the forces on replicas of points to the originals, and set them to zero.

    Writes: scene.points, replicas.
    """
    for k in range(piece.first_replica, piece.first_replica + piece.replica_count):
        b, original = scene.replicas[k], scene.originals[k]
        own = scene.points[original.point]
        add_to(own.force, vec(b.force))
        add_to(own.torque, vec(b.torque))
        load_point(own, b.load, b.spin_load, original.is_damped)
        put(b.force, (0.0, 0.0, 0.0))
        put(b.torque, (0.0, 0.0, 0.0))
        b.load = b.spin_load = 0.0


@kernel
def note_rates(clock, limit, scene):
    """The stiffest element of all pieces, of several the first, of none `limit`. Writes: clock."""
    clock.element_rate, clock.limit_element = 0.0, limit
    for k in range(scene.pieces.shape[0]):
        if scene.pieces[k].rate > clock.element_rate:
            clock.element_rate = scene.pieces[k].rate
            clock.limit_element = scene.pieces[k].element


@kernel
def largest_rate(scene):
    """The largest bound of frequency of all pieces."""
    rate = 0.0
    for k in range(scene.pieces.shape[0]):
        rate = max(rate, scene.pieces[k].rate)
    return rate


@kernel
def largest_speed(p, scene):
    """The largest speed that pieces have found of the points of a contact."""
    fastest = 0.0
    for k in range(scene.pieces.shape[0]):
        piece = scene.pieces[k]
        at = piece.first_point - p.first_point
        if at >= 0 and at < p.point_count:
            fastest = max(fastest, piece.speed)
    return fastest
