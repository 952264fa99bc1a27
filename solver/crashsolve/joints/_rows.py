"""The constraint rows from which joints are made, each with Jacobian and convective term.

With d = x_b - x_a between the joint's points, arms s_a, s_b from the mass centres, unit vectors
u_a, u_b fixed in the bodies, and gamma the right-hand side of D v_dot = gamma:

    point      Phi = u . d  for world axes u     gamma = -u . (w_b x (w_b x s_b) - w_a x (w_a x s_a))
    along      Phi = u_a . d  (u_a turns with a)
    square     Phi = u_a . u_b

Reference: Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems, ch. 9.
"""

from crashsolve.foundation.compile import kernel
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
def separation(p, nodes):
    """d = x_b - x_a and both arms."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    s_a, s_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    return sub(point_at(b, s_b), point_at(a, s_a)), s_a, s_b


@kernel
def centripetal(body, s):
    """Part w x (w x s) of the acceleration of a point of the body."""
    w = vec(body.w)
    return cross(w, cross(w, s))


@kernel
def point_residual(p, nodes, rows, r):
    """Three rows: the points coincide. Writes: rows."""
    d, _, _ = separation(p, nodes)
    for k in range(3):
        rows[r + k].phi = d[k]


@kernel
def point_jacobian(p, nodes, rows, r):
    """Writes: rows."""
    _, s_a, s_b = separation(p, nodes)
    for k in range(3):
        e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        write_row(rows[r + k], scale(-1.0, e), cross(e, s_a), e, cross(s_b, e))


@kernel
def point_convective(p, nodes, rows, r):
    """Writes: rows."""
    _, s_a, s_b = separation(p, nodes)
    g = sub(centripetal(nodes[p.node_a], s_a), centripetal(nodes[p.node_b], s_b))
    for k in range(3):
        rows[r + k].gamma = g[k]


@kernel
def along_residual(p, axis_a, nodes, row):
    """One row: no separation along an axis of body a (body components). Writes: row."""
    d, _, _ = separation(p, nodes)
    row.phi = dot(arm(nodes[p.node_a], vec(axis_a)), d)


@kernel
def along_jacobian(p, axis_a, nodes, row):
    """Writes: row."""
    d, s_a, s_b = separation(p, nodes)
    u = arm(nodes[p.node_a], vec(axis_a))
    write_row(row, scale(-1.0, u), cross(u, add(s_a, d)), u, cross(s_b, u))


@kernel
def along_convective(p, axis_a, nodes, row):
    """-(u_ddot . d + 2 u_dot . d_dot + u . d_ddot) without accelerations. Writes: row."""
    d, s_a, s_b = separation(p, nodes)
    a, b = nodes[p.node_a], nodes[p.node_b]
    u = arm(a, vec(axis_a))
    u_dot = cross(vec(a.w), u)
    d_dot = sub(point_velocity(b, s_b), point_velocity(a, s_a))
    spin = sub(centripetal(b, s_b), centripetal(a, s_a))
    row.gamma = -(dot(cross(vec(a.w), u_dot), d) + 2.0 * dot(u_dot, d_dot) + dot(u, spin))


@kernel
def square_residual(p, axis_a, axis_b, nodes, row):
    """One row: an axis of a stays at right angles to an axis of b. Writes: row."""
    row.phi = dot(arm(nodes[p.node_a], vec(axis_a)), arm(nodes[p.node_b], vec(axis_b)))


@kernel
def square_jacobian(p, axis_a, axis_b, nodes, row):
    """Writes: row."""
    c = cross(arm(nodes[p.node_a], vec(axis_a)), arm(nodes[p.node_b], vec(axis_b)))
    zero = (0.0, 0.0, 0.0)
    write_row(row, zero, c, zero, scale(-1.0, c))


@kernel
def square_convective(p, axis_a, axis_b, nodes, row):
    """Writes: row."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    u_a, u_b = arm(a, vec(axis_a)), arm(b, vec(axis_b))
    a_dot, b_dot = cross(vec(a.w), u_a), cross(vec(b.w), u_b)
    turn = dot(cross(vec(a.w), a_dot), u_b) + dot(u_a, cross(vec(b.w), b_dot))
    row.gamma = -(turn + 2.0 * dot(a_dot, b_dot))
