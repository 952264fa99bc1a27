"""Jobs that threads share, what a piece borrows before, and what the first thread does after."""

from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import load_point
from crashsolve.foundation.vec3 import put, vec

OPEN, DEFORM, LOAD, CLOSE, SPEED, LOOK = range(6)


@kernel
def lend(piece, scene):
    """Points that stand for others follow them, free of forces. Writes: scene.lent."""
    points, loans = scene.points, scene.loans
    for k in range(piece.first_loan, piece.first_loan + piece.loan_count):
        b, own = scene.lent[k], points[loans[k].point]
        put(b.r, vec(own.r))
        put(b.v, vec(own.v))
        put(b.w, vec(own.w))
        put(b.force, (0.0, 0.0, 0.0))
        put(b.torque, (0.0, 0.0, 0.0))
        b.mass_inv, b.J_inv, b.load, b.spin_load = own.mass_inv, own.J_inv, 0.0, 0.0


@kernel
def take_back(first, count, scene):
    """What points that stand for others have got of elements, in their order.

    Writes: scene.points.
    """
    loans, last = scene.loans, scene.pieces[first + count - 1]
    for k in range(scene.pieces[first].first_loan, last.first_loan + last.loan_count):
        b, own = scene.lent[k], scene.points[loans[k].point]
        add_to(own.force, vec(b.force))
        add_to(own.torque, vec(b.torque))
        load_point(own, b.load, b.spin_load, loans[k].slows)


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
