"""The points coincide: three rows, Phi = x_b - x_a along the axes of the world."""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import cross, scale, sub, unit
from crashsolve.joints._constraint_rows import centripetal, separation, write_row

ANGULAR = (False, False, False)


@kernel
def residual(p, nodes, rows, r):
    """Writes: rows."""
    d, _, _ = separation(nodes[p.node_a], nodes[p.node_b], p.point_a, p.point_b)
    for k in range(3):
        rows[r + k].phi = d[k]


@kernel
def jacobian(p, nodes, rows, r):
    """Writes: rows."""
    _, s_a, s_b = separation(nodes[p.node_a], nodes[p.node_b], p.point_a, p.point_b)
    for k in range(3):
        e = unit(k)
        write_row(rows[r + k], scale(-1.0, e), cross(e, s_a), e, cross(s_b, e))


@kernel
def convective(p, nodes, rows, r):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    _, s_a, s_b = separation(a, b, p.point_a, p.point_b)
    g = sub(centripetal(a, s_a), centripetal(b, s_b))
    for k in range(3):
        rows[r + k].gamma = g[k]
