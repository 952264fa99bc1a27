"""Three-node shell: constant strain and curvature, transverse shear assumed from the sides.

    G = w_j - w_i + s . (beta_i + beta_j) / 2,   of a side s from i to j, with the rotations beta
    gamma = sum G (N_i grad N_j - N_j grad N_i),   tau = 5/6 G gamma t^2 / (t^2 + 0.3 h^2)

with h^2 the mean square of the sides. The stress is weakened where the triangle is wide for its
thickness, which keeps thin plates from locking and vanishes as the mesh is refined. Its mean in
the element yields with the layers; its part about the middle is elastic.
Triangles are quadrilaterals whose last corner is their third, and share the axes of those; as both
have linear rotations along a side, they go together in one mesh. Consequence to test: any patch of
either holds constant strain and constant curvature.

References: Lee and Bathe (2004), Development of MITC isotropic triangular shell finite elements,
Computers and Structures 82, 945-962. Lyly, Stenberg and Vihinen (1993), A stable bilinear element
for the Reissner-Mindlin plate model, Computer Methods in Applied Mechanics and Engineering 110,
343-357. Katili (1993), A new discrete Kirchhoff-Mindlin element based on Mindlin-Reissner plate
theory and assumed shear strain fields, part I, Int. J. Num. Meth. Eng. 36, 1859-1883.
"""

from crashsolve.elements.shells.energies import (
    drilling_energy,
    in_plane,
    layer_energy,
    shear_energy,
)
from crashsolve.elements.shells.forces.blocks import Span
from crashsolve.elements.shells.forces.corners import before, corner, put_corner, three
from crashsolve.elements.shells.forces.quadrilateral import DRILLING, dot3, plane_axes
from crashsolve.elements.shells.forces.quadrilateral_block import integrate_shear, shape
from crashsolve.elements.shells.hourglass_return import relax_shear, set_trial_shear
from crashsolve.elements.shells.layers import layers
from crashsolve.elements.shells.records import BLOCK, EROSION, VISCOUS, WORK
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES

CORNERS, POINTS = 3, 1
# of the mean square of the sides, beside the thickness squared: (1 - nu) / 2.4 of a discrete
# Kirchhoff and Mindlin triangle (Katili 1993) for a metal
SOFTER = 0.3


@kernel
def span(p):
    """The Span of these elements in a part, behind the blocks of quadrilaterals."""
    quads, rows = p.element_count - p.triangles, BLOCK.SIZE + p.layer_rows * p.layers
    rows += VISCOUS.SIZE if p.is_damped == 1 else 0
    rows += EROSION.SIZE if p.erodes == 1 else 0
    filled = (quads + LANES - 1) // LANES
    first, corner = p.first + filled * p.stride, p.first_corner + 4 * LANES * filled
    return Span(first, corner, p.first_element + quads, LANES * rows, p.triangles)


@kernel
def stress(blocks, first, stride, work, h, p, curves, material):
    """Stresses after a step of h [s], and their resultants. Writes: blocks, work."""
    if p.yields == 1:
        set_trial_shear(blocks, first, work)
    if layers(blocks, first, stride, work, h, p, curves, material) > 0:
        relax_shear(blocks, first, work, p)


@inlined
def edges(flat):
    """Sides from corner 1 to 2, 2 to 3, 3 to 1."""
    return (flat[0] - flat[2], flat[1] - flat[3]), (flat[2], flat[3]), (-flat[0], -flat[1])


@inlined
def gradients(flat, area):
    """Slopes of the linear functions of the corners."""
    k = 0.5 / area
    d_x, d_y, e_x, e_y = flat
    return (-k * e_y, k * e_x), (k * d_y, -k * d_x), (k * (e_y - d_y), k * (d_x - e_x))


@inlined
def shear_factor_of(s, t):
    """Factor on the transverse shear stiffness of a triangle with these sides."""
    s1, s2, s3 = s
    h_2 = (dot2(s1, s1) + dot2(s2, s2) + dot2(s3, s3)) / 3.0
    return t * t / (t * t + SOFTER * h_2)


@inlined
def dot2(a, b):
    return a[0] * b[0] + a[1] * b[1]


@inlined
def mean_shear(g_i, g_j):
    """Mean transverse shear by G of a side."""
    return (g_j[0] - g_i[0]) / 3.0, (g_j[1] - g_i[1]) / 3.0


@inlined
def mean_shears(g1, g2, g3):
    """Mean transverse shear by the G of each side."""
    return mean_shear(g1, g2), mean_shear(g2, g3), mean_shear(g3, g1)


@inlined
def circulation_stiffness(s, area, t, G):
    """Stiffness over t against the sum of the three G, a shear that circulates about the middle.

    gamma = sum G / (2 A) e_z x (x - x_mean), whose square has the integral A / 36 sum |s|^2.
    """
    s1, s2, s3 = s
    squares = dot2(s1, s1) + dot2(s2, s2) + dot2(s3, s3)
    return 5.0 / 6.0 * G * shear_factor_of(s, t) * squares / (144.0 * area)


@inlined
def side_shear(s, w_i, w_j, x_i, x_j, y_i, y_j):
    """G of a side from deflections and from spins x and y at its ends."""
    return w_j - w_i + 0.5 * (s[0] * (y_i + y_j) - s[1] * (x_i + x_j))


@inlined
def plane_slopes(g1, g2, g3, u, axis):
    """Slopes by x and y of a vector at the corners along an axis."""
    a, b, c = dot3(u[0], axis), dot3(u[1], axis), dot3(u[2], axis)
    return g1[0] * a + g2[0] * b + g3[0] * c, g1[1] * a + g2[1] * b + g3[1] * c


@inlined
def of_corners(work, row, e):
    return corner(work, row, 0, e), corner(work, row, 1, e), corner(work, row, 2, e)


@inlined
def triangle_diagonals(x):
    """Vectors from the first corner to the third, and from the second to the third."""
    a, b, c = x
    return (c[0] - a[0], c[1] - a[1], c[2] - a[2]), (c[0] - b[0], c[1] - b[1], c[2] - b[2])


@blockwise
def strain(blocks, first, work, h, p):
    """Strains of a step of h, and the elastic stresses after it, with the geometry of its middle.

    Writes: work, blocks.
    """
    G, half = p.shear, 0.5 * h
    for e in range(LANES):
        x, v = of_corners(work, WORK.position, e), of_corners(work, WORK.velocity, e)
        rotation = of_corners(work, WORK.spin, e)
        d, c = triangle_diagonals(x)
        v_d, v_c = triangle_diagonals(v)
        axes, flat, area = plane_axes(
            before(d, half, v_d), before(c, half, v_c), shape(blocks, first + e)
        )
        g1, g2, g3 = gradients(flat, area)
        t = blocks[first + LANES * BLOCK.thickness + e]
        xx, xy = plane_slopes(g1, g2, g3, v, axes[0])
        yx, yy = plane_slopes(g1, g2, g3, v, axes[1])
        at = LANES * WORK.membrane + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, h * yy, h * (xy + yx)
        spin = dot3(rotation[0], axes[2]) + dot3(rotation[1], axes[2]) + dot3(rotation[2], axes[2])
        drill = 0.5 * (yx - xy) - spin / 3.0
        G1, G2, G3 = sides_of(edges(flat), v, rotation, axes)
        xx, xy = plane_slopes(g1, g2, g3, rotation, axes[1])
        yx, yy = plane_slopes(g1, g2, g3, rotation, axes[0])
        at = LANES * WORK.curvature + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, -h * yy, h * (xy - yx)
        s = edges(flat)
        stiff = h * t * circulation_stiffness(s, area, t, G)
        blocks[first + LANES * BLOCK.hourglass_plane + e] += stiff * (G1 + G2 + G3)
        m1, m2, m3 = mean_shears(g1, g2, g3)
        shear_factor = shear_factor_of(s, t)
        work[LANES * WORK.shear_factor + e] = shear_factor
        stiff, tie = h * 5.0 / 6.0 * G * shear_factor, h * DRILLING * G * t * area * drill
        x, y = m1[0] * G1 + m2[0] * G2 + m3[0] * G3, m1[1] * G1 + m2[1] * G2 + m3[1] * G3
        integrate_shear(blocks, work, first, e, stiff * x, stiff * y, tie)
        work[LANES * WORK.area + e] = area
        work[LANES * WORK.depth + e] = t


@inlined
def sides_of(s, v, rotation, axes):
    """G of the three sides for velocities and spins of the corners."""
    ex, ey, ez = axes
    w1, w2, w3 = dot3(v[0], ez), dot3(v[1], ez), dot3(v[2], ez)
    x1, x2, x3 = dot3(rotation[0], ex), dot3(rotation[1], ex), dot3(rotation[2], ex)
    y1, y2, y3 = dot3(rotation[0], ey), dot3(rotation[1], ey), dot3(rotation[2], ey)
    return (
        side_shear(s[0], w1, w2, x1, x2, y1, y2),
        side_shear(s[1], w2, w3, x2, x3, y2, y3),
        side_shear(s[2], w3, w1, x3, x1, y3, y1),
    )


@blockwise
def corner_forces(blocks, first, work, p):
    """Forces and torques on the corners from the stresses, and the bound of frequency.

    Writes: work.
    """
    for e in range(LANES):
        d, c = triangle_diagonals(of_corners(work, WORK.position, e))
        axes, flat, area = plane_axes(d, c, shape(blocks, first + e))
        t = blocks[first + LANES * BLOCK.thickness + e]
        N, M = three(work, LANES * WORK.resultant + e), three(work, LANES * WORK.moment + e)
        Q, at = blocks[first + LANES * BLOCK.hourglass_plane + e], first + LANES * BLOCK.shear + e
        V = (t * blocks[at], t * blocks[at + LANES])
        drill = 0.5 * blocks[first + LANES * BLOCK.drilling + e]
        g1, g2, g3 = gradients(flat, area)
        m1, m2, m3 = mean_shears(g1, g2, g3)
        F1, F2 = Q + area * dot2(V, m1), Q + area * dot2(V, m2)
        F3 = Q + area * dot2(V, m3)
        s1, s2, s3 = edges(flat)
        plane = (area, N, M, drill)
        put_node(work, 0, e, axes, plane, g1, (s3, F3), (s1, F1))
        put_node(work, 1, e, axes, plane, g2, (s1, F1), (s2, F2))
        put_node(work, 2, e, axes, plane, g3, (s2, F2), (s3, F3))
        radius_2 = blocks[first + LANES * BLOCK.gyration + e]
        work[LANES * WORK.rate + e] = rate_bound(
            flat, area, t, radius_2, p.young / p.density, p.poisson
        )


@inlined
def put_node(work, c, e, axes, plane, g, a, b):
    """Force and torque on a corner with the slopes g, from the plane and the two sides a and b.

    `plane`: area [m^2], N [N/m], M [N], half of drilling [N m]; of a side: vector [m], force [N].
    Writes: work.
    """
    (area, N, M, drill), (s_a, F_a), (s_b, F_b) = plane, a, b
    put_corner(
        work,
        WORK.force,
        c,
        e,
        axes,
        (
            area * (N[0] * g[0] + N[2] * g[1]) - drill * g[1],
            area * (N[2] * g[0] + N[1] * g[1]) + drill * g[0],
            F_a - F_b,
        ),
    )
    put_corner(
        work,
        WORK.torque,
        c,
        e,
        axes,
        (
            -area * (M[2] * g[0] + M[1] * g[1]) - 0.5 * (s_a[1] * F_a + s_b[1] * F_b),
            area * (M[0] * g[0] + M[2] * g[1]) + 0.5 * (s_a[0] * F_a + s_b[0] * F_b),
            -2.0 / 3.0 * drill,
        ),
    )


@inlined
def side_mobility(s, r, k, ends):
    """Mobility of G of two sides over that of a corner; they share one corner, or both ends."""
    return ends + 0.25 * k * abs(ends) * dot2(s, r)


@inlined
def shear_trace(flat, area, t, G, k):
    """Trace of the shear stiffness over t times the mobility of the three G; k is 1 / r^2."""
    s1, s2, s3 = edges(flat)
    g1, g2, g3 = gradients(flat, area)
    m1, m2, m3 = mean_shears(g1, g2, g3)
    trace = dot2(m1, m1) * side_mobility(s1, s1, k, 2.0) + dot2(m2, m2) * side_mobility(
        s2, s2, k, 2.0
    )
    trace += dot2(m3, m3) * side_mobility(s3, s3, k, 2.0) + 2.0 * dot2(m1, m2) * side_mobility(
        s1, s2, k, -1.0
    )
    trace += 2.0 * dot2(m2, m3) * side_mobility(s2, s3, k, -1.0)
    trace += 2.0 * dot2(m3, m1) * side_mobility(s3, s1, k, -1.0)
    # the deflections take no part in the sum of the G
    circulation = 0.25 * k * (dot2(s1, s1) + dot2(s2, s2) + dot2(s3, s3))
    mean = 5.0 / 6.0 * G * area * shear_factor_of((s1, s2, s3), t)
    return mean * trace + circulation_stiffness((s1, s2, s3), area, t, G) * circulation


@kernel
def rate_bound(flat, area, t, radius_2, E_rho, nu):
    """Bound of the largest squared frequency of the free element [1/s^2].

    Row sums of M^-1 K of the plane; of bending against rotary inertia, with the trace for shear.
    """
    g1, g2, g3 = gradients(flat, area)
    xx = 3.0 * (g1[0] * g1[0] + g2[0] * g2[0] + g3[0] * g3[0])
    yy = 3.0 * (g1[1] * g1[1] + g2[1] * g2[1] + g3[1] * g3[1])
    xy = 3.0 * abs(g1[0] * g1[1] + g2[0] * g2[1] + g3[0] * g3[1])
    plane = max(xx + nu * yy, yy + nu * xx) + (1.0 + nu) * xy
    plane = max(plane, 0.5 * (1.0 - nu) * (xx + yy + 2.0 * xy))
    plane *= E_rho / (1.0 - nu * nu)
    bending = plane * t * t / (12.0 * radius_2)
    shear = shear_trace(flat, area, t, 0.5 * E_rho / (1.0 + nu), 1.0 / radius_2)
    return max(plane, bending + 3.0 / area * shear)


@kernel
def element_energy(p, blocks, at, d, e, material):
    """Elastic energy of the layers and of transverse shear, none of hourglass, drilling [J]."""
    t, flat, area = in_plane(blocks, at, d, e)
    total = shear_energy(p, blocks, at) / shear_factor_of(edges(flat), t)
    total += layer_energy(p, blocks, at + LANES * BLOCK.SIZE, material)
    Q = blocks[at + LANES * BLOCK.hourglass_plane]
    circulation = t * circulation_stiffness(edges(flat), area, t, p.shear)
    stored = area * t * total + 0.5 * Q * Q / circulation
    return stored, 0.0, drilling_energy(p, blocks, at, t, area)
