"""The constraint rows from which joints are made, each with Jacobian and convective term.

With d = x_b - x_a between the joint's points, arms s_a, s_b from the mass centres, unit vectors
u_a, u_b fixed in the bodies, and theta the angle of b about an axis of a:

    point      Phi = u . d  for world axes u
    slide      Phi = u_a . d  (u_a turns with a)
    square     Phi = u_a . u_b
    angle      Phi = theta  (see foundation/angles.py)

gamma, the right-hand side of D v_dot = gamma, is -Phi_ddot of bodies that move on without
accelerations (Ambrosio (2003), Eq. 1-3).
Reference: Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems, ch. 9.
"""

from crashsolve.foundation.angles import angle_gradient
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, point_at, point_velocity
from crashsolve.foundation.vec3 import add, cross, dot, scale, sub, vec


@kernel
def write_row(row, v_a, w_a, v_b, w_b):
    """One row of D; nu = 0. Writes: row."""
    D = row.D
    for k in range(3):
        D[k] = v_a[k]
        D[3 + k] = w_a[k]
        D[6 + k] = v_b[k]
        D[9 + k] = w_b[k]
    row.nu = 0.0


@kernel
def separation(a, b, point_a, point_b):
    """d = x_b - x_a and both arms [m]."""
    s_a, s_b = arm(a, vec(point_a)), arm(b, vec(point_b))
    return sub(point_at(b, s_b), point_at(a, s_a)), s_a, s_b


@kernel
def centripetal(body, s):
    """Part w x (w x s) of the acceleration of a point of the body [m/s^2]."""
    w = vec(body.w)
    return cross(w, cross(w, s))


@kernel
def slide_along(a, b, point_a, point_b, axis_a):
    """Separation along an axis of body a [m]."""
    d, _, _ = separation(a, b, point_a, point_b)
    return dot(arm(a, vec(axis_a)), d)


@kernel
def slide_jacobian(a, b, point_a, point_b, axis_a, row):
    """Writes: row."""
    d, s_a, s_b = separation(a, b, point_a, point_b)
    u = arm(a, vec(axis_a))
    write_row(row, scale(-1.0, u), cross(u, add(s_a, d)), u, cross(s_b, u))


@kernel
def slide_jacobian_rate(a, b, point_a, point_b, axis_a):
    """u_ddot . d + 2 u_dot . d_dot + u . d_ddot of bodies without accelerations [m/s^2]."""
    d, s_a, s_b = separation(a, b, point_a, point_b)
    u = arm(a, vec(axis_a))
    u_dot = cross(vec(a.w), u)
    d_dot = sub(point_velocity(b, s_b), point_velocity(a, s_a))
    spin = sub(centripetal(b, s_b), centripetal(a, s_a))
    return dot(cross(vec(a.w), u_dot), d) + 2.0 * dot(u_dot, d_dot) + dot(u, spin)


@kernel
def square_residual(p, axis_a, axis_b, nodes):
    """Phi of an axis of a at right angles to an axis of b: the cosine between them [1]."""
    return dot(arm(nodes[p.node_a], vec(axis_a)), arm(nodes[p.node_b], vec(axis_b)))


@kernel
def square_jacobian(p, axis_a, axis_b, nodes, row):
    """Writes: row."""
    c = cross(arm(nodes[p.node_a], vec(axis_a)), arm(nodes[p.node_b], vec(axis_b)))
    zero = (0.0, 0.0, 0.0)
    write_row(row, zero, c, zero, scale(-1.0, c))


@kernel
def square_convective(p, axis_a, axis_b, nodes):
    """gamma of the same [1/s^2]."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    u_a, u_b = arm(a, vec(axis_a)), arm(b, vec(axis_b))
    a_dot, b_dot = cross(vec(a.w), u_a), cross(vec(b.w), u_b)
    rotation = dot(cross(vec(a.w), a_dot), u_b) + dot(u_a, cross(vec(b.w), b_dot))
    return -(rotation + 2.0 * dot(a_dot, b_dot))


@kernel
def rotation_jacobian(a, b, axis_a, side_b, row):
    """Writes: row."""
    g = angle_gradient(a, b, axis_a, side_b)
    zero = (0.0, 0.0, 0.0)
    write_row(row, zero, scale(-1.0, g), zero, g)


@kernel
def also_rotates(row, g):
    """Add the rotation of b against a, with gradient g, to a row. Writes: row.D."""
    for k in range(3):
        row.D[3 + k] -= g[k]
        row.D[9 + k] += g[k]


@kernel
def scale_row(row, factor):
    """Writes: row.D."""
    for k in range(12):
        row.D[k] *= factor
