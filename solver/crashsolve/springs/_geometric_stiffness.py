"""Rotation of a force along a line: the stiffness that its row omits, in the blocks of its nodes.

    dF = T (I - u u^T) (dx_b - dx_a) / l,   dx = dr + dtheta x d
    on a: dF, d_a x dF + T (dtheta_a x d_a) x u;   on b: -dF, -d_b x dF - T (dtheta_b x d_b) x u

The row D^T k D of a spring is its whole tangent where it bears no force; a force rotates with
the line and with the arms. Only where nodes have blocks, for elements of beams or shells: rows
alone could hold only the symmetric part of a tension, in two more of them for each spring.
Consequence to test: rows and blocks together are the derivative of the force.
"""

from typing import NamedTuple

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.sparse.bordered import subtract_coupling, subtract_own
from crashsolve.foundation.vec3 import ZERO, Vector, add, cross, dot, scale, sub, unit
from crashsolve.springs._between import SHORTEST, line_of_action


class End(NamedTuple):
    """One end of the line."""

    u: Vector  # unit vector to the other end
    tension: float  # [N]
    length: float  # between both [m]
    d: Vector  # arm of this end [m]
    d_far: Vector  # arm of the other


@kernel
def add_geometric_stiffness(p, out, nodes, slot, blocks):
    """Subtract the derivatives of the force's direction by every motion of both ends.

    Writes: blocks.
    """
    u, length, _, d_a, d_b = line_of_action(p, nodes)
    if length < SHORTEST:
        return
    at_a = End(u, out.force, length, d_a, d_b)
    at_b = End(scale(-1.0, u), out.force, length, d_b, d_a)
    for k in range(6):
        if slot.a >= 0:
            rotation_end(slot.a, (slot.across, slot.flips == 1), k, at_a, blocks)
        if slot.b >= 0:
            rotation_end(slot.b, (slot.across, slot.flips == 0), k, at_b, blocks)


@kernel
def rotation_end(own, far, k, end, blocks):
    """Motion k of this end, whose block is `own`. Writes: blocks."""
    direction, (across, is_column) = unit(k % 3), far
    swung = cross(direction, end.d) if k >= 3 else ZERO
    f = rotated(end.u, end.tension / end.length, direction if k < 3 else swung)
    on_own = add(cross(end.d, f), cross(swung, scale(end.tension, end.u)))
    subtract_own(blocks[own], k, f, on_own)
    if across >= 0:
        back = scale(-1.0, f)
        subtract_coupling(blocks[across], k, is_column, back, cross(end.d_far, back))


@kernel
def rotated(u, per, direction):
    """Change of the force on an end [N/m] by a displacement in this direction; `per` is the tension
    over l.
    """
    return scale(per, sub(scale(dot(u, direction), u), direction))
