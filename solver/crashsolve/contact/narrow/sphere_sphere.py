"""Gap between two spheres (or points: radius 0).

    depth = r_a + r_b - |c_a - c_b|

Point of contact: midway between the deepest points of both.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.vec3 import add_scaled, norm, scale, sub, vec


@kernel
def gap(a, b, nodes, data):
    """Depth [m] (negative: a gap), unit normal out of b, point of contact; world components."""
    other = world_position(nodes[b.node], vec(b.point))
    line = sub(world_position(nodes[a.node], vec(a.point)), other)
    length = norm(line)
    # centres that coincide have no direction
    n = scale(1.0 / length, line) if length > 0.0 else (0.0, 0.0, 1.0)
    depth = a.radius + b.radius - length
    return depth, n, add_scaled(other, b.radius - 0.5 * depth, n)
