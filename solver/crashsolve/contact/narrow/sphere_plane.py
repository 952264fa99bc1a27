"""Gap between a sphere (or a point: radius 0) and a plane.

    depth = r - (c - x_0) . n

Point of contact: the deepest of the sphere, c - r n.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, world_position
from crashsolve.foundation.vec3 import add_scaled, dot, sub, vec


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    centre = world_position(nodes[a.node], vec(a.point))
    origin = world_position(nodes[b.node], vec(b.point))
    n = arm(nodes[b.node], vec(b.normal))
    depth = a.radius - dot(sub(centre, origin), n)
    return depth, n, add_scaled(centre, -a.radius, n)
