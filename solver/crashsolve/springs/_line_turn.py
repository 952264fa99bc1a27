"""Turn of a force along a line: what its row leaves out, in the blocks of its nodes.

    dF = T (I - u u^T) (dx_b - dx_a) / l,   dx = dr + dtheta x d
    on a: dF, d_a x dF + T (dtheta_a x d_a) x u;   on b: -dF, -d_b x dF - T (dtheta_b x d_b) x u

The row D^T k D of a spring is all of its tangent where it bears nothing; what it bears turns with
the line and with the arms. Only where nodes have blocks, for elements of beams or shells: rows
alone could hold no more than what is symmetric and pulls, in two more of them for each spring.
Consequence to test: rows and blocks together are the derivative of the force.
"""

from crashsolve.foundation.bordered import resist_far, resist_own
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.vec3 import add, cross, dot, scale, sub
from crashsolve.springs._between import SHORTEST, line_of_action

NONE = (0.0, 0.0, 0.0)


@kernel
def turn_line(p, tension, nodes, place, blocks):
    """Less the derivatives by every motion of both ends. Writes: blocks."""
    u, length, _, d_a, d_b = line_of_action(p, nodes)
    if length < SHORTEST:
        return
    for k in range(6):
        way = unit(k)
        if place.a >= 0:
            swung = cross(way, d_a) if k >= 3 else NONE
            f = turned(u, tension / length, scale(-1.0, way if k < 3 else swung))
            on_a = add(cross(d_a, f), cross(swung, scale(tension, u)))
            resist_own(blocks[place.a], k, f, on_a)
            if place.across >= 0:
                back = scale(-1.0, f)
                resist_far(blocks[place.across], k, place.flips == 1, back, cross(d_b, back))
        if place.b >= 0:
            swung = cross(way, d_b) if k >= 3 else NONE
            f = turned(u, tension / length, way if k < 3 else swung)
            on_b = add(cross(d_b, f), cross(swung, scale(tension, u)))
            resist_own(blocks[place.b], k, scale(-1.0, f), scale(-1.0, on_b))
            if place.across >= 0:
                resist_far(blocks[place.across], k, place.flips == 0, f, cross(d_a, f))


@kernel
def unit(k):
    """Direction of motion k: along x, y, z, then about them."""
    i = k % 3
    return (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)


@kernel
def turned(u, per, way):
    """Change of the force on a as b moves over a; `per` is the tension over the length."""
    return scale(per, sub(way, scale(dot(u, way), u)))
