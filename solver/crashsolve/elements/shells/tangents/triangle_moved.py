"""How strains and forces of a three-node shell change when its corners move: derivatives, by hand.

    d S = B du + (dB) u,   d f = B^T d sigma + (dB)^T sigma

as quadrilateral_moved.py has it, with transverse shear from the sides. Consequence to test: the
derivative of the forces that the step computes.

References: those of elements/triangle.py.
"""

from crashsolve.elements.shells.forces.corners import four, three
from crashsolve.elements.shells.forces.quadrilateral import slopes
from crashsolve.elements.shells.forces.triangle import (
    SOFTER,
    dot2,
    edges,
    gradients,
    mean_shears,
    shear_factor_of,
    side_shear,
)
from crashsolve.elements.shells.tangents.quadrilateral import geometry_at
from crashsolve.elements.shells.tangents.quadrilateral_moved import slopes_moved
from crashsolve.elements.shells.tangents.records import BASE, CHANGE
from crashsolve.foundation.kernels import inlined
from crashsolve.foundation.point import LANES


@inlined
def sides_of(s, w, x, y):
    """G of the three sides; w is (D, E) of the deflection, x and y are corner rotations."""
    return (
        side_shear(s[0], 0.0, w[0] - w[1], x[0], x[1], y[0], y[1]),
        side_shear(s[1], 0.0, w[1], x[1], x[2], y[1], y[2]),
        side_shear(s[2], w[0], 0.0, x[2], x[0], y[2], y[0]),
    )


@inlined
def summed(m, G):
    """Shear by the G of the sides."""
    x = m[0][0] * G[0] + m[1][0] * G[1] + m[2][0] * G[2]
    return x, m[0][1] * G[0] + m[1][1] * G[1] + m[2][1] * G[2]


@inlined
def strains(u, rotation, geometry):
    """Strains of the plane, curvatures; shear without its factor, circulation, drilling.

    u is (x, y, z) of D and E of the displacements, turn that of the rotations of the corners.
    """
    (flat, skew, _, area), (x, y, z) = geometry, rotation
    xx, xy, _ = slopes(u[0][0], u[0][1], 0.0, flat, skew, area)
    yx, yy, _ = slopes(u[1][0], u[1][1], 0.0, flat, skew, area)
    m_x, m_y, _ = slopes(y[2] - y[0], y[2] - y[1], 0.0, flat, skew, area)
    n_x, n_y, _ = slopes(x[0] - x[2], x[1] - x[2], 0.0, flat, skew, area)
    G = sides_of(edges(flat), u[2], x, y)
    shear = summed(mean_shears(*gradients(flat, area)), G)
    drill = 0.5 * (yx - xy) - (z[0] + z[1] + z[2]) / 3.0
    return (xx, yy, xy + yx), (m_x, n_y, m_y + n_x), (*shear, G[0] + G[1] + G[2], drill)


@inlined
def gradients_moved(geometry, moved):
    """Change of gradients() with the geometry."""
    flat, _, _, area = geometry
    # slopes are as the diagonals over the area
    a, b, share = gradients(flat, area), gradients(moved[0], area), moved[3] / area
    return (
        (b[0][0] - share * a[0][0], b[0][1] - share * a[0][1]),
        (b[1][0] - share * a[1][0], b[1][1] - share * a[1][1]),
        (b[2][0] - share * a[2][0], b[2][1] - share * a[2][1]),
    )


@inlined
def strains_moved(u, rotation, geometry, moved):
    """Change of strains() with the geometry."""
    (flat, _, _, area), (x, y, _) = geometry, rotation
    xx, xy, _ = slopes_moved(u[0][0], u[0][1], 0.0, geometry, moved)
    yx, yy, _ = slopes_moved(u[1][0], u[1][1], 0.0, geometry, moved)
    m_x, m_y, _ = slopes_moved(y[2] - y[0], y[2] - y[1], 0.0, geometry, moved)
    n_x, n_y, _ = slopes_moved(x[0] - x[2], x[1] - x[2], 0.0, geometry, moved)
    G, still = sides_of(edges(flat), u[2], x, y), (0.0, 0.0)
    dG = sides_of(edges(moved[0]), still, x, y)
    a = summed(mean_shears(*gradients_moved(geometry, moved)), G)
    b = summed(mean_shears(*gradients(flat, area)), dG)
    others = (a[0] + b[0], a[1] + b[1], dG[0] + dG[1] + dG[2], 0.5 * (yx - xy))
    return (xx, yy, xy + yx), (m_x, n_y, m_y + n_x), others


@inlined
def softer_by(s, ds, t):
    """Change of weakened(), over it, and of the squares of the sides, over them."""
    squares = dot2(s[0], s[0]) + dot2(s[1], s[1]) + dot2(s[2], s[2])
    more = 2.0 * (dot2(s[0], ds[0]) + dot2(s[1], ds[1]) + dot2(s[2], ds[2]))
    return -shear_factor_of(s, t) * SOFTER * more / (3.0 * t * t), more / squares


@inlined
def side_changes(base, change, e):
    """Sides, thickness before the step; softer_by()."""
    s, t = (
        edges(geometry_at(base, LANES * BASE.middle + e)[0]),
        base[LANES * BASE.thickness_before + e],
    )
    weaker, wider = softer_by(s, edges(four(change, LANES * CHANGE.moved + e)), t)
    return s, t, weaker, wider


@inlined
def stress_of(table, at):
    """N, M, circulation, V, half of the drilling."""
    V = (table[at + 12 * LANES], table[at + 13 * LANES])
    N, M = three(table, at), three(table, at + 3 * LANES)
    return N, M, table[at + 6 * LANES], V, table[at + 14 * LANES]


@inlined
def around(V, Q, flat):
    """Generalized forces on the G of each side: gradients over one half are those times the
    area.
    """
    m1, m2, m3 = mean_shears(*gradients(flat, 1.0))
    return Q + dot2(V, m1), Q + dot2(V, m2), Q + dot2(V, m3)


@inlined
def on_corner(N, M, drill, g, slope, w):
    """Force and torque on a corner by its slopes, those times the area, and its share of shear."""
    f = (N[0] * g[0] + N[2] * g[1] - drill * slope[1], N[2] * g[0] + N[1] * g[1], w)
    f = (f[0], f[1] + drill * slope[0], f[2])
    return f, (-M[2] * g[0] - M[1] * g[1], M[0] * g[0] + M[2] * g[1], -2.0 / 3.0 * drill)


@inlined
def with_sides(t, a, F_a, b, F_b):
    """A torque with that of two sides."""
    x, y = 0.5 * (a[0] * F_a + b[0] * F_b), 0.5 * (a[1] * F_a + b[1] * F_b)
    return t[0] - y, t[1] + x, t[2]


@inlined
def generalized_forces(stress, geometry):
    """Forces and torques on the corners, in the element's axes."""
    (N, M, Q, V, drill), (flat, _, _, area) = stress, geometry
    g, slope, s = gradients(flat, 1.0), gradients(flat, area), edges(flat)
    F1, F2, F3 = around(V, Q, flat)
    f1, t1 = on_corner(N, M, drill, g[0], slope[0], F3 - F1)
    f2, t2 = on_corner(N, M, drill, g[1], slope[1], F1 - F2)
    f3, t3 = on_corner(N, M, drill, g[2], slope[2], F2 - F3)
    t1, t2 = with_sides(t1, s[2], F3, s[0], F1), with_sides(t2, s[0], F1, s[1], F2)
    return (f1, f2, f3), (t1, t2, with_sides(t3, s[1], F2, s[2], F3))


@inlined
def pushes_moved(stress, geometry, moved):
    """Change of pushes() with the geometry."""
    (N, M, Q, V, drill), s, ds = stress, edges(geometry[0]), edges(moved[0])
    g, slope = gradients(moved[0], 1.0), gradients_moved(geometry, moved)
    F1, F2, F3 = around(V, Q, geometry[0])
    d1, d2, d3 = around(V, 0.0, moved[0])
    f1, t1 = on_corner(N, M, drill, g[0], slope[0], d3 - d1)
    f2, t2 = on_corner(N, M, drill, g[1], slope[1], d1 - d2)
    f3, t3 = on_corner(N, M, drill, g[2], slope[2], d2 - d3)
    t1, t2 = with_sides(t1, s[2], d3, s[0], d1), with_sides(t2, s[0], d1, s[1], d2)
    t3 = with_sides(t3, s[1], d2, s[2], d3)
    t1, t2 = with_sides(t1, ds[2], F3, ds[0], F1), with_sides(t2, ds[0], F1, ds[1], F2)
    t3, rest = with_sides(t3, ds[1], F2, ds[2], F3), 2.0 / 3.0 * drill
    # the torque of drilling does not depend on the geometry
    t1, t2, t3 = (*t1[:2], t1[2] + rest), (*t2[:2], t2[2] + rest), (*t3[:2], t3[2] + rest)
    return (f1, f2, f3), (t1, t2, t3)
