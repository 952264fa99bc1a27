"""Motion of points fixed in bodies, forces on them, and how easily they move.

`body` is a row of the node table. A point lies at r + d, d = A s; it moves with v + w x d. A force
f there adds f to the body's force and d x f to its torque about the mass centre.
"""

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.vec3 import add, add_to, cross, dot, matvec, sub, vec


@kernel
def arm(body, point):
    """World vector from the mass centre to a point fixed in the body; also turns directions."""
    return matvec(body.A, point)


@kernel
def point_at(body, d):
    """World position of the point d from the mass centre."""
    return add(vec(body.r), d)


@kernel
def place(body, point):
    """World position of a point given in body axes from the mass centre."""
    return add(vec(body.r), matvec(body.A, point))


@kernel
def point_velocity(body, d):
    """Velocity of the point d from the mass centre, world axes."""
    return add(vec(body.v), cross(vec(body.w), d))


@kernel
def relative(a, d_a, b, d_b):
    """Vector from a point of body a to a point of body b, and its rate."""
    x = sub(point_at(b, d_b), point_at(a, d_a))
    return x, sub(point_velocity(b, d_b), point_velocity(a, d_a))


@kernel
def apply_force(body, f, d):
    """Force f at distance d from the mass centre. Writes: body."""
    add_to(body.force, f)
    add_to(body.torque, cross(d, f))


@kernel
def note_late(body, f, d):
    """Part of an applied force that the step now ending has not felt. Writes: body."""
    add_to(body.late_force, f)
    add_to(body.late_torque, cross(d, f))


@kernel
def apply_torque(body, t):
    """Pure torque t. Writes: body."""
    add_to(body.torque, t)


@kernel
def mobility(body, d, u):
    """Acceleration of a point along unit vector u per unit force along u [1/kg]."""
    c = cross(d, u)
    return body.mass_inv + dot(c, matvec(body.W, c))


@kernel
def spin_mobility(body, u):
    """Angular acceleration about unit vector u per unit torque [1/(kg m^2)]."""
    return dot(u, matvec(body.W, u))


@kernel
def stiffen(body, mobility, stiffness, damping):
    """Tell the step control of a spring on this body. Writes: body."""
    body.stiffness += stiffness * mobility
    body.damping += damping * mobility


@kernel
def apply_external(nodes, i, f, d, t):
    """Force f at d and torque t from outside on body i. Writes: nodes."""
    body, ground = nodes[i], nodes[0]
    apply_force(body, f, d)
    apply_torque(body, t)
    moment = add(cross(point_at(body, d), f), t)
    for k in range(3):
        ground.external[k] += f[k]
        ground.external[3 + k] += moment[k]
