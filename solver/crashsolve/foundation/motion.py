"""Motion of points fixed in bodies, forces on them, and how easily they move.

`body` is a row of the node table. A point lies at r + d, d = A s; it moves with v + w x d. A force
f there adds f to the body's force and d x f to its torque about the mass centre.
"""

from typing import NamedTuple

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import Vector, add, cross, dot, scale, sub, vec


@kernel
def arm(body, point):
    """World vector from the mass centre to a point fixed in the body; also rotates directions."""
    return matvec(body.A, point)


@kernel
def point_at(body, d):
    """World position of the point d from the mass centre."""
    return add(vec(body.r), d)


@kernel
def world_position(body, point):
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
def apply_wrench(body, f, d, t):
    """Force f at distance d from the mass centre and torque t. Writes: body."""
    add_to(body.force, f)
    add_to(body.torque, add(cross(d, f), t))


@kernel
def add_deferred(body, f, d):
    """Part of an applied force that the step now ending did not contain. Writes: body."""
    add_to(body.deferred_force, f)
    add_to(body.deferred_torque, cross(d, f))


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
def welded_response(body, d, force, moment):
    """Mobility of all that welds fix to the body, for a unit force at d and a torque [1/kg]."""
    rotation = add(cross(sub(d, matvec(body.A, vec(body.welded_at))), force), moment)
    rotation_b = matvec_t(body.A, rotation)
    return dot(force, force) * body.welded_mass_inv + dot(
        rotation_b, matvec(body.welded_J_inv, rotation_b)
    )


@kernel
def spin_mobility(body, u):
    """Angular acceleration about unit vector u per unit torque [1/(kg m^2)]."""
    return dot(u, matvec(body.W, u))


@kernel
def add_stiffness_bound(body, mobility, stiffness, damping):
    """Report a spring on this body to the step control. Writes: body."""
    body.stiffness += stiffness * mobility
    body.damping += damping * mobility


@kernel
def pull(p, nodes, tension, u, d_a, d_b, stiffness, damping):
    """Tension along u on a at d_a and on b at d_b, and its stiffness. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    f = scale(tension, u)
    apply_force(a, f, d_a)
    apply_force(b, scale(-1.0, f), d_b)
    add_stiffness_bound(a, mobility(a, d_a, u), stiffness, damping)
    add_stiffness_bound(b, mobility(b, d_b, u), stiffness, damping)


@kernel
def twist(p, nodes, torque, g, stiffness, damping):
    """Torque along g that rotates b back towards a, and its stiffness. Writes: nodes."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    apply_torque(a, scale(torque, g))
    apply_torque(b, scale(-torque, g))
    add_stiffness_bound(a, spin_mobility(a, g), stiffness, damping)
    add_stiffness_bound(b, spin_mobility(b, g), stiffness, damping)


class Line(NamedTuple):
    """The line from a point of a to one of b, along which a spring acts."""

    u: Vector  # unit vector
    length: float  # [m]
    rate: float  # of the length [m/s]
    d_a: Vector  # arms of both points [m]
    d_b: Vector


@kernel
def line_tangent(row, a, b, line, stiffness, damping):
    """Tangent of a force along the line from a to b. Writes: row."""
    u, length, _, d_a, d_b = line
    v = sub(point_velocity(b, d_b), point_velocity(a, d_a))
    u_dot = scale(1.0 / length, sub(v, scale(dot(u, v), u))) if length > 0.0 else (0.0, 0.0, 0.0)
    point_tangent(row, u, d_a, d_b, stiffness, damping)
    swing(row.G, 0, 1.0, u_dot, cross(u, vec(a.w)), d_a)
    swing(row.G, 6, -1.0, u_dot, cross(u, vec(b.w)), d_b)


@kernel
def axis_tangent(row, a, b, u, d_a, d_b, stiffness, damping):
    """Tangent of a force along u, fixed in a, in the point d_b of b. Writes: row."""
    v = sub(point_velocity(b, d_b), point_velocity(a, d_a))
    at_a, at_b = cross(u, vec(a.w)), cross(u, vec(b.w))
    point_tangent(row, u, d_a, d_b, stiffness, damping)
    swing(row.G, 0, -1.0, at_a, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    swing(row.G, 6, 1.0, at_a, scale(-1.0, at_b), d_b)
    rotation = cross(v, u)
    for k in range(3):
        row.G[3 + k] = rotation[k]


@kernel
def rotation_tangent(row, a, b, g, stiffness, damping):
    """Tangent of a torque along g, fixed in a, on a and against it on b. Writes: row."""
    D, G = row.D, row.G
    rotation = cross(g, sub(vec(a.w), vec(b.w)))
    for k in range(3):
        D[k] = D[6 + k] = G[k] = G[6 + k] = G[9 + k] = 0.0
        D[3 + k] = g[k]
        D[9 + k] = -g[k]
        G[3 + k] = rotation[k]
    row.stiffness = stiffness
    row.damping = damping


@kernel
def point_tangent(row, u, d_a, d_b, stiffness, damping):
    """Tangent of a force along u, but for the rotation of u, that pulls d_a to d_b. Writes: row."""
    rotation_a, rotation_b, D = cross(d_a, u), cross(d_b, u), row.D
    for k in range(3):
        D[k] = u[k]
        D[3 + k] = rotation_a[k]
        D[6 + k] = -u[k]
        D[9 + k] = -rotation_b[k]
    for k in range(12):
        row.G[k] = 0.0
    row.stiffness = stiffness
    row.damping = damping


@kernel
def swing(G, c, sign, u_dot, carried, d):
    """Columns c to c + 5 of G: `u_dot` is du/dt, `carried` is u x w of the body. Writes: G."""
    rotation = cross(d, add(u_dot, carried))
    for k in range(3):
        G[c + k] = sign * u_dot[k]
        G[c + 3 + k] = sign * rotation[k]


@kernel
def no_tangent(row):
    """A force that does not change. Writes: row."""
    row.stiffness = 0.0
    row.damping = 0.0


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


@kernel
def act_from_outside(ground, f, moment):
    """Force and moment about the origin that come from outside. Writes: ground."""
    for k in range(3):
        ground.external[k] += f[k]
        ground.external[3 + k] += moment[k]


@kernel
def load_point(b, load, spin_load, is_damped):
    """Add the stiffness of an element to that of its corner; with damping, keep the largest.

    Writes: b.
    """
    if is_damped == 1:
        b.load, b.spin_load = max(b.load, load), max(b.spin_load, spin_load)
    else:
        b.load += load
        b.spin_load += spin_load
