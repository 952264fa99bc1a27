"""Mobilities of the sides of a contact, and sums over bodies that welds join to one.

A body that joints of type weld fix to others yields to a contact with the inertia of all of them
(model/welded.py): the mass of the law, the damping and friction that a step can resolve, and the
bound of the step are those of the whole, and all contacts on any body of it count together.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import welded_response
from crashsolve.foundation.vec3 import ZERO, dot, scale
from crashsolve.system.contact import areas, touches
from crashsolve.system.placeholders import WELDED


@kernel
def pair_mobility(a, b, d_a, d_b, n):
    """Mobilities of both sides along the normal [1/kg]."""
    if WELDED:
        return welded_response(a, d_a, n, ZERO), welded_response(b, d_b, n, ZERO)
    return touches.pair_mobility(a, b, d_a, d_b, n)


@kernel
def friction_mobility(a, b, d_a, d_b, u, n, radius):
    """Mobilities of both sides for friction along u, slip and spin of length 1 [1/kg]."""
    if WELDED:
        force, moment = areas.along_surface(u, n), scale(radius * dot(u, n), n)
        return welded_response(a, d_a, force, moment), welded_response(b, d_b, force, moment)
    return areas.friction_mobility(a, b, d_a, d_b, u, n, radius)


@kernel
def begin_contacts(nodes):
    """Keep what springs and elements report to the step control. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        body = nodes[i]
        body.own_stiffness, body.own_damping = body.stiffness, body.damping


@kernel
def share_contacts(nodes):
    """What contacts report on the bodies of a whole counts for each of these. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        body = nodes[i]
        if body.welded_first != i:
            first = nodes[body.welded_first]
            first.stiffness += body.stiffness - body.own_stiffness
            first.damping += body.damping - body.own_damping
            first.damped += body.damped
            first.pressed += body.pressed
    for i in range(1, nodes.shape[0]):
        body = nodes[i]
        if body.welded_first != i:
            first = nodes[body.welded_first]
            body.stiffness = body.own_stiffness + first.stiffness - first.own_stiffness
            body.damping = body.own_damping + first.damping - first.own_damping
            body.damped, body.pressed = first.damped, first.pressed
