"""Tangent of the three-node shell: its forces by motions of its corners, as of the four-node shell.

    dG = dw_j - dw_i + s . (dbeta_i + dbeta_j) / 2 + ds . (beta_i + beta_j) / 2

of a side s, and the slopes of the plane as those of a quadrilateral whose fourth corner is the
third: without an hourglass. Consequence to test: central differences of the forces.

References: those of _triangle.py and _layer_tangent.py.
"""

from crashsolve.foundation.compile import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import ZERO
from crashsolve.parts._beside import relax_shear, see_shear
from crashsolve.parts._layer_tangent import (
    ACROSS_OUT,
    SHEAR_IN,
    TAKEN_OUT,
    layers_and_tangent,
)
from crashsolve.parts._layers import clear_growth, clear_resultants, take_up
from crashsolve.parts._quad import dot3, plane_axes, slopes
from crashsolve.parts._quad_block import (
    DRILL,
    DRILLING,
    LAYERS,
    MOMENT,
    PLACE,
    PLANE_Q,
    RESULTANT,
    SHEAR,
    SPIN,
    THICKNESS,
    VELOCITY,
    before,
    four,
    gather,
    put_corner,
    shape,
    three,
)
from crashsolve.parts._quad_moved import NONE, change_of, slopes_moved, turn_of_axes
from crashsolve.parts._shell_tangent import (
    both_changed,
    end_moved,
    geometry_at,
    motions_at,
    put_frame,
    relaxation,
    see_taken,
    sum_turned,
    times3,
)
from crashsolve.parts._tangent import (
    ABOUT,
    AFTER,
    AXES,
    BEFORE,
    COMES,
    DIRECTION,
    END,
    ENTERS,
    MID,
    MODE,
    MOVED,
    OUT,
    POINTS,
    PUSHED,
    STRAIN,
    STRESS,
    STRESSED,
    TAU,
    TOOK,
    TURNED,
    WAY,
    add_column,
    add_damping,
    axes_at,
    enter_strains,
    put_four,
    put_three,
    respond,
    turn_arms,
    turn_corner,
)
from crashsolve.parts._triangle import (
    SOFTER,
    dot2,
    edges,
    gradients,
    mean_shears,
    of_corners,
    side_shear,
    start_of,
    strain,
    stride_of,
    triangle_diagonals,
    weakened,
    whirl_stiffness,
)
from crashsolve.parts._viscous import damp


@kernel
def tangent(p, h, scene, matrix):
    """Tangents of the triangles of a part at the end of a step of h.

    Writes: matrix.blocks, scene.lanes, work, seen, change.
    """
    start, start_corner, _ = start_of(p)
    stride, done, blocks, work, seen = stride_of(p), 0, scene.lanes, scene.work, scene.seen
    while done < p.triangles:
        first, corner = start + done // LANES * stride, start_corner + 4 * done
        gather(scene.points, scene.corners, corner, work)
        strain(blocks, first, work, h, p)
        clear_growth(work)
        clear_resultants(work)
        see_shear(blocks, first, work)
        at = first + LANES * LAYERS
        layers_and_tangent(
            blocks, scene.lanes_before, at, work, seen, LANES * POINTS, h, p, scene.curves
        )
        relax_shear(blocks, first, work, p)
        take_up(blocks, first, stride, work, h, p)
        if p.slows == 1:
            damp(blocks, first, stride, work, h, p)
            add_damping(seen, LANES * POINTS, work, h, p)
        see(blocks, scene.lanes_before, first, work, seen, h)
        add_columns(p, h, scene, matrix, corner, min(LANES, p.triangles - done))
        done += LANES


@kernel
def add_columns(p, h, scene, matrix, corner, live):
    """All columns of a block into the matrix. Writes: matrix.blocks, scene.change."""
    seen, change = scene.seen, scene.change
    if scene.counts[0].arms > 0:
        push_at_rest(seen, change)
        turn_arms(scene, matrix, change, corner, live, 3)
    for b in range(3):
        # shares of a corner in D and E
        d, c = b - 1.0, 0.5 * b * (3.0 * b - 5.0)
        for k in range(3):
            strain_by_place(seen, change, k, d, c)
            stress_by(seen, change, p)
            push_by_place(seen, change, k, d, c)
            add_column(scene, matrix, change, corner, live, b, k, 3)
        for k in range(3):
            turn_corner(scene.work, change, b, k, h)
            strain_by_turn(seen, change, b)
            stress_by(seen, change, p)
            push_by_turn(seen, change)
            add_column(scene, matrix, change, corner, live, b, 3 + k, 3)


@blockwise
def see(blocks, kept, first, work, seen, h):
    """Both frames, the motion of the step and the stresses after it; `kept` is from before it.

    Writes: seen.
    """
    see_motion(blocks, first, work, seen, h)
    for e in range(LANES):
        to, at = LANES * STRESS + e, first + e
        put_three(seen, to, three(work, LANES * RESULTANT + e))
        put_three(seen, to + 3 * LANES, three(work, LANES * MOMENT + e))
        t, tau = blocks[at + LANES * THICKNESS], LANES * TAU + e
        x, y = blocks[at + LANES * SHEAR], blocks[at + LANES * (SHEAR + 1)]
        put_four(seen, to + 6 * LANES, (blocks[at + LANES * PLANE_Q], 0.0, 0.0, 0.0))
        put_four(seen, to + 10 * LANES, (0.0, 0.0, t * x, t * y))
        seen[to + 14 * LANES] = 0.5 * blocks[at + LANES * DRILL]
        seen[tau], seen[tau + LANES] = x, y
        seen[LANES * BEFORE + e], seen[LANES * AFTER + e] = kept[at + LANES * THICKNESS], t
        u, turn = motions_at(seen, LANES * WAY + e), motions_at(seen, LANES * TURNED + e)
        _, _, others = strains(u, turn, geometry_at(seen, LANES * MID + e))
        put_four(seen, LANES * MODE + e, others)
        see_taken(work, seen, e)
    for e in range(LANES):
        forces, torques = pushes(stress_at(seen, e), geometry_at(seen, LANES * END + e))
        at = LANES * PUSHED + e
        for c in range(3):
            put_three(seen, at + 3 * c * LANES, forces[c])
            put_three(seen, at + (9 + 3 * c) * LANES, torques[c])


@inlined
def put_corners_of(seen, at, axes, h, a, b, c):
    """h times three vectors along the axes, and no fourth. Writes: seen."""
    for k in range(3):
        x, y, z = dot3(a, axes[k]), dot3(b, axes[k]), dot3(c, axes[k])
        put_four(seen, at + 4 * LANES * k, (h * x, h * y, h * z, 0.0))


@blockwise
def see_motion(blocks, first, work, seen, h):
    """Frames of the middle and of the end, displacements and turns of the step. Writes: seen."""
    half = 0.5 * h
    for e in range(LANES):
        G, w = shape(blocks, first + e), of_corners(work, SPIN, e)
        d, c = triangle_diagonals(of_corners(work, PLACE, e))
        v_d, v_c = triangle_diagonals(of_corners(work, VELOCITY, e))
        put_frame(seen, LANES * END + e, plane_axes(d, c, G), ZERO, G)
        frame = plane_axes(before(d, half, v_d), before(c, half, v_c), G)
        put_frame(seen, LANES * MID + e, frame, ZERO, G)
        put_corners_of(seen, LANES * WAY + e, frame[0], h, v_d, v_c, ZERO)
        put_corners_of(seen, LANES * TURNED + e, frame[0], h, w[0], w[1], w[2])


@inlined
def sides_of(s, w, x, y):
    """G of the three sides; w is (D, E) of the deflection, x and y are the turns of the corners."""
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
def strains(u, turn, geometry):
    """Strains of the plane, curvatures; shear (not weakened), what goes round, drilling.

    u is (x, y, z) of D and E of the displacements, turn that of the turns of the corners.
    """
    (flat, skew, _, area), (x, y, z) = geometry, turn
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
def strains_moved(u, turn, geometry, moved):
    """Change of strains() with the geometry."""
    (flat, _, _, area), (x, y, _) = geometry, turn
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
def put_strains(change, e, a, b):
    """The sum of two changes of strains. Writes: change."""
    (d, bent, others), (d_moved, bent_moved, others_moved) = a, b
    at = LANES * STRAIN + e
    for k in range(3):
        change[at + LANES * k] = d[k] + d_moved[k]
        change[at + LANES * (3 + k)] = bent[k] + bent_moved[k]
    for k in range(4):
        change[at + LANES * (6 + k)] = others[k] + others_moved[k]


@blockwise
def strain_by_place(seen, change, k, d, c):
    """Change of the strains as a corner moves along axis k. Writes: change."""
    for e in range(LANES):
        at = LANES * MID + e
        row = at + LANES * (AXES + k)
        n = (seen[row], seen[row + 3 * LANES], seen[row + 6 * LANES])
        # the middle of the step moves half as far
        geometry = geometry_at(seen, at)
        D, E = times3(0.5 * d, n), times3(0.5 * c, n)
        turn = turn_of_axes(geometry, four(seen, at + LANES * ABOUT), D, E)
        moved = change_of(geometry, turn, D, E, ZERO)
        u, w = motions_at(seen, LANES * WAY + e), motions_at(seen, LANES * TURNED + e)
        du, dw = both_changed(turn, u, n, (d, c, 0.0, 0.0)), both_changed(turn, w, n, NONE)
        put_strains(change, e, strains(du, dw, geometry), strains_moved(u, w, geometry, moved))
        put_four(change, LANES * MOVED + e, moved[0])
        change[LANES * (MOVED + 4) + e] = moved[3]


@blockwise
def strain_by_turn(seen, change, b):
    """Change of the strains as corner b turns as `change` says. Writes: change."""
    s = (0.5 * (b - 1.0) * (b - 2.0), b * (2.0 - b), 0.5 * b * (b - 1.0), 0.0)
    for e in range(LANES):
        at = LANES * MID + e
        axes, way = axes_at(seen, at + LANES * AXES), three(change, LANES * DIRECTION + e)
        n = (dot3(axes[0], way), dot3(axes[1], way), dot3(axes[2], way))
        turn = both_changed(ZERO, (NONE, NONE, NONE), n, s)
        found = strains((NONE, NONE, NONE), turn, geometry_at(seen, at))
        put_strains(change, e, found, (ZERO, ZERO, NONE))
        put_four(change, LANES * MOVED + e, NONE)
        change[LANES * (MOVED + 4) + e] = 0.0


@inlined
def softer_by(s, ds, t):
    """Change of weakened(), over it, and of the squares of the sides, over them."""
    squares = dot2(s[0], s[0]) + dot2(s[1], s[1]) + dot2(s[2], s[2])
    more = 2.0 * (dot2(s[0], ds[0]) + dot2(s[1], ds[1]) + dot2(s[2], ds[2]))
    return -weakened(s, t) * SOFTER * more / (3.0 * t * t), more / squares


@blockwise
def stress_by(seen, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    enter_strains(change)
    for e in range(LANES):
        tau = LANES * (ENTERS + SHEAR_IN) + e
        change[tau], change[tau + LANES] = shear_by(seen, change, e, p)
    respond(seen, LANES * POINTS, change)
    for row in range(6 * LANES):
        change[LANES * STRESSED + row] = change[LANES * COMES + row]
    for e in range(LANES):
        change[LANES * TOOK + e] = change[LANES * (COMES + TAKEN_OUT) + e]
        shear_and_tie_by(seen, change, e, p)


@inlined
def side_changes(seen, change, e):
    """Sides, thickness before the step; softer_by()."""
    s, t = edges(geometry_at(seen, LANES * MID + e)[0]), seen[LANES * BEFORE + e]
    weaker, wider = softer_by(s, edges(four(change, LANES * MOVED + e)), t)
    return s, t, weaker, wider


@inlined
def shear_by(seen, change, e, p):
    """Change of the trial transverse shear."""
    s, t, weaker, _ = side_changes(seen, change, e)
    k = 5.0 / 6.0 * p.shear * weakened(s, t)
    u, du = four(seen, LANES * MODE + e), four(change, LANES * (STRAIN + 6) + e)
    return k * (du[0] + weaker * u[0]), k * (du[1] + weaker * u[1])


@inlined
def shear_and_tie_by(seen, change, e, p):
    """Change of what goes round, of transverse shear and of drilling. Writes: change."""
    s, t, weaker, wider = side_changes(seen, change, e)
    area, to = geometry_at(seen, LANES * MID + e)[3], LANES * STRESSED + e
    more, after = change[LANES * (MOVED + 4) + e], seen[LANES * AFTER + e]
    u, du = four(seen, LANES * MODE + e), four(change, LANES * (STRAIN + 6) + e)
    k = t * whirl_stiffness(s, area, t, p.shear)
    Q = k * (du[2] + (weaker + wider - more / area) * u[2])
    put_four(change, to + 6 * LANES, (Q, 0.0, 0.0, 0.0))
    # large strain grows the logarithm of the thickness
    across = change[LANES * (COMES + ACROSS_OUT) + e]
    thinner = (after if p.hyper == 1 else t) * across if p.thins == 1 else 0.0
    left, less = relaxation(seen, change, e)
    still, tau, trial = thinner - after * less, LANES * TAU + e, LANES * (ENTERS + SHEAR_IN) + e
    V_x = after * left * change[trial] + still * seen[tau]
    V_y = after * left * change[trial + LANES] + still * seen[tau + LANES]
    put_four(change, to + 10 * LANES, (0.0, 0.0, V_x, V_y))
    drill = 0.5 * left * DRILLING * p.shear * t * (area * du[3] + more * u[3])
    change[to + 14 * LANES] = drill - less * seen[LANES * (STRESS + 14) + e]


@inlined
def stress_of(table, at):
    """N, M, what goes round, V, half of the drilling."""
    V = (table[at + 12 * LANES], table[at + 13 * LANES])
    N, M = three(table, at), three(table, at + 3 * LANES)
    return N, M, table[at + 6 * LANES], V, table[at + 14 * LANES]


@inlined
def stress_at(seen, e):
    """Stresses after the step."""
    return stress_of(seen, LANES * STRESS + e)


@inlined
def around(V, Q, flat):
    """What acts on the G of each side: gradients over one half are those times the area."""
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
def pushes(stress, geometry):
    """What acts on the motions of the corners, in the element's axes: forces and torques."""
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


@blockwise
def push_at_rest(seen, change):
    """Forces on the corners themselves. Writes: change."""
    for e in range(LANES):
        axes, row = axes_at(seen, LANES * (END + AXES) + e), LANES * PUSHED + e
        for c in range(3):
            put_corner(change, OUT, c, e, axes, three(seen, row + 3 * c * LANES))


@blockwise
def push_by_turn(seen, change):
    """Change of the forces with that of the stresses. Writes: change."""
    for e in range(LANES):
        at = LANES * END + e
        forces, torques = pushes(stress_of(change, LANES * STRESSED + e), geometry_at(seen, at))
        axes = axes_at(seen, at + LANES * AXES)
        for c in range(3):
            put_corner(change, OUT, c, e, axes, forces[c])
            put_corner(change, OUT + 12, c, e, axes, torques[c])


@blockwise
def push_by_place(seen, change, k, d, c):
    """Change of the forces as a corner moves along axis k. Writes: change."""
    for e in range(LANES):
        at, row = LANES * END + e, LANES * PUSHED + e
        geometry, axes = geometry_at(seen, at), axes_at(seen, at + LANES * AXES)
        turn, moved = end_moved(seen, e, k, d, c, 0.0)
        f, t = pushes(stress_of(change, LANES * STRESSED + e), geometry)
        F, T = pushes_moved(stress_at(seen, e), geometry, moved)
        for j in range(3):
            own = three(seen, row + 3 * j * LANES), three(seen, row + (9 + 3 * j) * LANES)
            put_corner(change, OUT, j, e, axes, sum_turned(f[j], F[j], turn, own[0]))
            put_corner(change, OUT + 12, j, e, axes, sum_turned(t[j], T[j], turn, own[1]))
