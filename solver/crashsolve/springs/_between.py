"""What springs between two points or about one axis share: geometry and application."""

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.motion import (
    apply_force,
    apply_torque,
    arm,
    mobility,
    relative,
    spin_mobility,
    stiffen,
)
from crashsolve.foundation.vec3 import dot, norm, scale, vec

# below this length a line has no direction; the spring then pulls along x, with its rate zero
SHORTEST = 1e-12


@kernel
def line_of_action(p, nodes):
    """Unit vector from a to b, distance, its rate, and the arms of both ends."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    x, x_dot = relative(a, d_a, b, d_b)
    length = norm(x)
    if length < SHORTEST:
        return (1.0, 0.0, 0.0), length, 0.0, d_a, d_b
    u = scale(1.0 / length, x)
    return u, length, dot(u, x_dot), d_a, d_b


@kernel
def pull(p, nodes, tension, u, d_a, d_b, stiffness, damping):
    """Tension along u on both ends, and its stiffness for the step. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    f = scale(tension, u)
    apply_force(a, f, d_a)
    apply_force(b, scale(-1.0, f), d_b)
    stiffen(a, mobility(a, d_a, u), stiffness, damping)
    stiffen(b, mobility(b, d_b, u), stiffness, damping)


@kernel
def twist(p, nodes, torque, u, stiffness, damping):
    """Torque about u that turns b back towards a, on both bodies. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    apply_torque(a, scale(torque, u))
    apply_torque(b, scale(-torque, u))
    stiffen(a, spin_mobility(a, u), stiffness, damping)
    stiffen(b, spin_mobility(b, u), stiffness, damping)
