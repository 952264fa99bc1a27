"""Tangent of the four-node shell with one point in its plane: its forces by motions of its corners.

    K = B_end^T (C B_mid + (dC) S) + (dB_end)^T sigma,   C with the tangent of the layers' return

in columns, one for each motion of each corner, sixteen elements side by side. Strains are those of
the middle of the step and forces those of its end: K is not symmetric. Consequence to test: central
differences of the forces give the same, in large turns and beyond yield.

References: those of _quad.py and _layer_tangent.py.
"""

from math import sqrt

from crashsolve.foundation.compile import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import ZERO
from crashsolve.parts._beside import (
    clear_weak,
    mode_sizes,
    relax_modes,
    relax_shear,
    see_modes,
    see_shear,
)
from crashsolve.parts._layer_tangent import (
    ACROSS_OUT,
    MODES_IN,
    SHEAR_IN,
    TAKEN_OUT,
    layers_and_tangent,
)
from crashsolve.parts._layers import AMPLITUDE as WORK_AMPLITUDE
from crashsolve.parts._layers import SQUARES, clear_resultants, take_up, taken_modes
from crashsolve.parts._layers import TAKEN as WORK_TAKEN
from crashsolve.parts._quad import cross3, dot3, hourglass_stiffness, plane_axes, sides
from crashsolve.parts._quad_block import (
    DRILLING,
    LAYERS,
    MOMENT,
    PLACE,
    PLANE_Q,
    RESULTANT,
    SPIN,
    THICKNESS,
    VELOCITY,
    along,
    before,
    diagonals,
    four,
    gather,
    put_corners,
    shape,
    strain,
    three,
)
from crashsolve.parts._quad_moved import (
    NONE,
    change_of,
    pushes,
    pushes_moved,
    spin_slopes,
    strains,
    strains_moved,
    turn_of_axes,
)
from crashsolve.parts._tangent import (
    ABOUT,
    ACROSS,
    AFTER,
    AMPLITUDE,
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
    SIDES,
    SIZE,
    SKEW,
    STRAIN,
    STRESS,
    STRESSED,
    TAKEN,
    TAKEN_MODES,
    TAU,
    TOOK,
    TURNED,
    WAY,
    add_column,
    add_damping,
    axes_at,
    enter_strains,
    put_axes,
    put_four,
    put_three,
    respond,
    shares,
    turn_arms,
    turn_corner,
)
from crashsolve.parts._viscous import damp


@kernel
def tangent(p, h, scene, matrix):
    """Tangents of the one-point elements of a part at the end of a step of h.

    Writes: matrix.blocks, scene.lanes, work, seen, change.
    """
    done, blocks, work, seen = 0, scene.lanes, scene.work, scene.seen
    clear_weak(work)
    while done < p.one_point:
        first, corner = p.first + done // LANES * p.stride, p.first_corner + 4 * done
        gather(scene.points, scene.corners, corner, work)
        strain(blocks, first, work, h, p)
        clear_resultants(work)
        see_shear(blocks, first, work)
        see_modes(blocks, first, work)
        at = first + LANES * LAYERS
        layers_and_tangent(
            blocks, scene.lanes_before, at, work, seen, LANES * POINTS, h, p, scene.curves
        )
        relax_modes(blocks, first, work)
        relax_shear(blocks, first, work, p)
        take_up(blocks, first, p.stride, work, h, p)
        if p.slows == 1:
            damp(blocks, first, p.stride, work, h, p)
            add_damping(seen, LANES * POINTS, work, h, p)
        see(blocks, scene.lanes_before, first, work, seen, h)
        add_columns(p, h, scene, matrix, corner, min(LANES, p.one_point - done))
        done += LANES


@kernel
def add_columns(p, h, scene, matrix, corner, live):
    """All columns of a block into the matrix. Writes: matrix.blocks, scene.change."""
    seen, change = scene.seen, scene.change
    if scene.counts[0].arms > 0:
        push_at_rest(seen, change)
        turn_arms(scene, matrix, change, corner, live, 4)
    for b in range(4):
        d, c, g = shares(b)
        for k in range(3):
            strain_by_place(seen, change, k, d, c, g)
            stress_by(seen, change, p)
            push_by_place(seen, change, k, d, c, g)
            add_column(scene, matrix, change, corner, live, b, k, 4)
        for k in range(3):
            turn_corner(scene.work, change, b, k, h)
            strain_by_turn(seen, change, d, c, g)
            stress_by(seen, change, p)
            push_by_turn(seen, change)
            add_column(scene, matrix, change, corner, live, b, 3 + k, 4)


@inlined
def put_frame(seen, at, frame, x, G):
    """Axes and geometry of an element with the diagonals x. Writes: seen."""
    axes, flat, area = frame
    put_axes(seen, at + LANES * AXES, axes)
    put_four(seen, at + LANES * SIDES, flat)
    put_three(
        seen, at + LANES * SKEW, (dot3(x, axes[0]), dot3(x, axes[1]), 0.25 * dot3(x, axes[2]))
    )
    seen[at + LANES * SIZE] = area
    put_four(seen, at + LANES * ABOUT, spin_slopes(flat, G))


@inlined
def geometry_at(seen, at):
    """(flat, hourglass, z, area) of a frame."""
    h_x, h_y, z = three(seen, at + LANES * SKEW)
    return four(seen, at + LANES * SIDES), (h_x, h_y), z, seen[at + LANES * SIZE]


@inlined
def motions_at(seen, at):
    """x, y and z of (D, E, H, S)."""
    return four(seen, at), four(seen, at + 4 * LANES), four(seen, at + 8 * LANES)


@inlined
def put_motions(seen, at, axes, h, u):
    """h u along the axes. Writes: seen."""
    for k in range(3):
        x = along(axes[k], u)
        put_four(seen, at + 4 * LANES * k, (h * x[0], h * x[1], h * x[2], h * x[3]))


@inlined
def stress_at(seen, e):
    """Stresses by the names of pushes()."""
    at = LANES * STRESS + e
    q, s = four(seen, at + 6 * LANES), four(seen, at + 10 * LANES)
    pairs = (s[0], s[1]), (s[2], s[3])
    return three(seen, at), three(seen, at + 3 * LANES), q, *pairs, seen[at + 14 * LANES]


@blockwise
def see(blocks, kept, first, work, seen, h):
    """Both frames, the motion of the step and the stresses after it; `kept` is from before it.

    Writes: seen.
    """
    see_motion(blocks, first, work, seen, h)
    see_stress(blocks, kept, first, work, seen)
    for e in range(LANES):
        geometry = geometry_at(seen, LANES * END + e)
        (D, E, H), (t_d, t_e, t_h, t_s) = pushes(stress_at(seen, e), geometry)
        at = LANES * PUSHED + e
        put_three(seen, at, D)
        put_three(seen, at + 3 * LANES, E)
        put_three(seen, at + 6 * LANES, H)
        put_three(seen, at + 9 * LANES, t_d)
        put_three(seen, at + 12 * LANES, t_e)
        put_three(seen, at + 15 * LANES, t_h)
        put_three(seen, at + 18 * LANES, t_s)


@blockwise
def see_motion(blocks, first, work, seen, h):
    """Frames of the middle and of the end, displacements and turns of the step. Writes: seen."""
    half = 0.5 * h
    for e in range(LANES):
        x, v, w = diagonals(work, PLACE, e), diagonals(work, VELOCITY, e), diagonals(work, SPIN, e)
        G = shape(blocks, first + e)
        put_frame(seen, LANES * END + e, plane_axes(x[0], x[1], G), x[2], G)
        d, c, g = before(x[0], half, v[0]), before(x[1], half, v[1]), before(x[2], half, v[2])
        frame = plane_axes(d, c, G)
        put_frame(seen, LANES * MID + e, frame, g, G)
        put_motions(seen, LANES * WAY + e, frame[0], h, v)
        put_motions(seen, LANES * TURNED + e, frame[0], h, w)


@blockwise
def see_stress(blocks, kept, first, work, seen):
    """Stresses after the step, and what they were found with. Writes: seen."""
    for e in range(LANES):
        at, to = first + LANES * PLANE_Q + e, LANES * STRESS + e
        put_three(seen, to, three(work, LANES * RESULTANT + e))
        put_three(seen, to + 3 * LANES, three(work, LANES * MOMENT + e))
        put_four(seen, to + 6 * LANES, four(blocks, at))
        t, shear = blocks[first + LANES * THICKNESS + e], three(blocks, at + 6 * LANES)
        pair = (blocks[at + 4 * LANES], blocks[at + 5 * LANES])
        put_four(seen, to + 10 * LANES, (*pair, t * shear[0], t * shear[1]))
        seen[to + 14 * LANES] = 0.5 * shear[2]
        at = LANES * TAU + e
        seen[at], seen[at + LANES] = shear[0], shear[1]
        seen[LANES * BEFORE + e] = kept[first + LANES * THICKNESS + e]
        seen[LANES * AFTER + e] = t
        geometry = geometry_at(seen, LANES * MID + e)
        _, _, q, _, change, drill = strains(
            motions_at(seen, LANES * WAY + e), motions_at(seen, LANES * TURNED + e), geometry
        )
        put_four(seen, LANES * MODE + e, q)
        put_three(seen, LANES * (MODE + 4) + e, (*change, drill))
        see_taken(work, seen, e)


@inlined
def see_taken(work, seen, e):
    """What yielding takes, and of what. Writes: seen."""
    seen[LANES * TAKEN + e], taken = work[LANES * WORK_TAKEN + e], taken_modes(work, e)
    for m in range(4):
        # of stresses, as the tangent of the layers has them
        over = sqrt(work[LANES * (SQUARES + m % 2) + e])
        seen[LANES * (TAKEN_MODES + m) + e] = over * taken[m]
        seen[LANES * (AMPLITUDE + m) + e] = over * work[LANES * (WORK_AMPLITUDE + m) + e]


@inlined
def both_changed(turn, u, n, s):
    """Change of (x, y, z) of (D, E, H, S), axes turning, as corners move by n with shares s."""
    x, y, z = u
    return (
        grown(n[0], s, turn[2], y, -turn[1], z),
        grown(n[1], s, turn[0], z, -turn[2], x),
        grown(n[2], s, turn[1], x, -turn[0], y),
    )


@inlined
def grown(n, s, a, u, b, v):
    """n s + a u + b v."""
    return (
        n * s[0] + a * u[0] + b * v[0],
        n * s[1] + a * u[1] + b * v[1],
        n * s[2] + a * u[2] + b * v[2],
        n * s[3] + a * u[3] + b * v[3],
    )


@inlined
def plus(a, b):
    return a[0] + b[0], a[1] + b[1]


@inlined
def plus3(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def times3(s, a):
    return s * a[0], s * a[1], s * a[2]


@inlined
def put_strains(change, e, found):
    """Writes: change."""
    d, b, q, gamma, bent, drill = found
    at = LANES * STRAIN + e
    put_three(change, at, d)
    put_three(change, at + 3 * LANES, b)
    put_four(change, at + 6 * LANES, q)
    put_four(change, at + 10 * LANES, (*gamma, *bent))
    change[at + 14 * LANES] = drill


@blockwise
def strain_by_place(seen, change, k, d, c, g):
    """Change of the strains as a corner moves along axis k. Writes: change."""
    for e in range(LANES):
        at = LANES * MID + e
        row = at + LANES * (AXES + k)
        n = (seen[row], seen[row + 3 * LANES], seen[row + 6 * LANES])
        # the middle of the step moves half as far
        half, geometry = (0.5 * n[0], 0.5 * n[1], 0.5 * n[2]), geometry_at(seen, at)
        D, E = times3(d, half), times3(c, half)
        turn = turn_of_axes(geometry, four(seen, at + LANES * ABOUT), D, E)
        moved = change_of(geometry, turn, D, E, times3(g, half))
        u, w = motions_at(seen, LANES * WAY + e), motions_at(seen, LANES * TURNED + e)
        du, dw = both_changed(turn, u, n, (d, c, g, 1.0)), both_changed(turn, w, n, NONE)
        a, b = strains(du, dw, geometry), strains_moved(u, w, geometry, moved)
        q = (a[2][0] + b[2][0], a[2][1] + b[2][1], a[2][2] + b[2][2], a[2][3] + b[2][3])
        found = (plus3(a[0], b[0]), plus3(a[1], b[1]), q, plus(a[3], b[3]), plus(a[4], b[4]))
        put_strains(change, e, (*found, a[5] + b[5]))
        put_four(change, LANES * MOVED + e, moved[0])
        change[LANES * (MOVED + 4) + e] = moved[3]


@blockwise
def strain_by_turn(seen, change, d, c, g):
    """Change of the strains as a corner turns as `change` says. Writes: change."""
    for e in range(LANES):
        at = LANES * MID + e
        axes, way = axes_at(seen, at + LANES * AXES), three(change, LANES * DIRECTION + e)
        n, s = (dot3(axes[0], way), dot3(axes[1], way), dot3(axes[2], way)), (d, c, g, 1.0)
        turn = both_changed(ZERO, (NONE, NONE, NONE), n, s)
        put_strains(change, e, strains((NONE, NONE, NONE), turn, geometry_at(seen, at)))
        put_four(change, LANES * MOVED + e, NONE)
        change[LANES * (MOVED + 4) + e] = 0.0


@inlined
def stiffness_moved(flat, moved, area, grown_by, p, t):
    """Change of hourglass_stiffness() with the geometry."""
    (a_x, a_y, b_x, b_y), (c_x, c_y, d_x, d_y) = sides(flat), sides(moved)
    plane, shear = p.young * t * 4.0 / (3.0 * area), 5.0 / 72.0 * p.shear * t / area
    k, k_s = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    share = grown_by / area
    return (
        2.0 * plane * (a_y * c_y + b_y * d_y) - share * k[0],
        2.0 * plane * (a_x * c_x + b_x * d_x) - share * k[1],
        plane * p.poisson * (a_x * c_y + c_x * a_y + b_x * d_y + d_x * b_y) - share * k[2],
    ), (
        2.0 * shear * (b_x * d_x + b_y * d_y) - share * k_s[0],
        2.0 * shear * (a_x * c_x + a_y * c_y) - share * k_s[1],
    )


@blockwise
def stress_by(seen, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    enter_strains(change)
    for e in range(LANES):
        modes_by(seen, change, e, p)
        enter_shear(change, e, 5.0 / 6.0 * p.shear)
    respond(seen, LANES * POINTS, change)
    for row in range(6 * LANES):
        change[LANES * STRESSED + row] = change[LANES * COMES + row]
    for e in range(LANES):
        change[LANES * TOOK + e] = change[LANES * (COMES + TAKEN_OUT) + e]
        change[LANES * ACROSS + e] = change[LANES * (COMES + ACROSS_OUT) + e]
        relax_modes_by(seen, change, e)
    stress_of_shear(seen, change, p)


@inlined
def enter_shear(change, e, stiff):
    """The trial transverse shear enters at a point. Writes: change."""
    at, to = LANES * (STRAIN + 10) + e, LANES * (ENTERS + SHEAR_IN) + e
    change[to], change[to + LANES] = stiff * change[at], stiff * change[at + LANES]


@inlined
def sizes_at(seen, change, e):
    """r_x and r_y of the middle, and their change."""
    flat = four(seen, LANES * (MID + SIDES) + e)
    (a_x, a_y, b_x, b_y), moved = sides(flat), sides(four(change, LANES * MOVED + e))
    x, y = mode_sizes(flat)
    r_x, r_y = sqrt(x), sqrt(y)
    d_x = 4.0 / 3.0 * (a_y * moved[1] + b_y * moved[3]) / r_x
    d_y = 4.0 / 3.0 * (a_x * moved[0] + b_x * moved[2]) / r_y
    return (r_x, r_y), (d_x, d_y)


@inlined
def modes_by(seen, change, e, p):
    """Change of the trial stresses of the modes; their amplitudes enter. Writes: change."""
    frame, to, at = LANES * MID + e, LANES * (STRESSED + 6) + e, LANES * (STRAIN + 6) + e
    flat, area, t = (
        four(seen, frame + LANES * SIDES),
        seen[frame + LANES * SIZE],
        seen[LANES * BEFORE + e],
    )
    moved, more = four(change, LANES * MOVED + e), change[LANES * (MOVED + 4) + e]
    k, _ = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    j, _ = stiffness_moved(flat, moved, area, more, p, t)
    u, d, bend = four(seen, LANES * MODE + e), four(change, at), t * t / 12.0
    Q = (
        k[0] * d[0] + k[2] * d[1] + j[0] * u[0] + j[2] * u[1],
        k[1] * d[1] + k[2] * d[0] + j[1] * u[1] + j[2] * u[0],
        bend * (k[0] * d[2] + k[2] * d[3] + j[0] * u[2] + j[2] * u[3]),
        bend * (k[1] * d[3] + k[2] * d[2] + j[1] * u[3] + j[2] * u[2]),
    )
    put_four(change, to, Q)
    sizes, grow = sizes_at(seen, change, e)
    for m in range(4):
        over = (1.0 if m < 2 else 1.0 / bend) / (t * sizes[m % 2])
        share = grow[m % 2] / sizes[m % 2]
        amplitude = seen[LANES * (AMPLITUDE + m) + e]
        change[LANES * (ENTERS + MODES_IN + m) + e] = over * Q[m] - share * amplitude


@inlined
def relax_modes_by(seen, change, e):
    """What yielding takes of the change of the stresses of the modes. Writes: change."""
    t, (sizes, grow) = seen[LANES * BEFORE + e], sizes_at(seen, change, e)
    for m in range(4):
        taken = seen[LANES * (TAKEN_MODES + m) + e]
        more = change[LANES * (COMES + MODES_IN + m) + e]
        less = t * (grow[m % 2] * taken + sizes[m % 2] * more)
        change[LANES * (STRESSED + 6 + m) + e] -= less


@blockwise
def stress_of_shear(seen, change, p):
    """Change of what acts on the change of shear, of V and of drilling. Writes: change."""
    for e in range(LANES):
        frame, to, at = LANES * MID + e, LANES * (STRESSED + 10) + e, LANES * (STRAIN + 10) + e
        flat, area = four(seen, frame + LANES * SIDES), seen[frame + LANES * SIZE]
        t = seen[LANES * BEFORE + e]
        moved, more = four(change, LANES * MOVED + e), change[LANES * (MOVED + 4) + e]
        _, k = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
        _, j = stiffness_moved(flat, moved, area, more, p, t)
        u, d = three(seen, LANES * (MODE + 4) + e), three(change, at + 2 * LANES)
        # large strain grows the logarithm of the thickness
        thick = seen[LANES * AFTER + e] if p.hyper == 1 else t
        thinner = thick * change[LANES * ACROSS + e] if p.thins == 1 else 0.0
        tau, after = LANES * TAU + e, seen[LANES * AFTER + e]
        left, less = relaxation(seen, change, e)
        stiff, still = left * after * 5.0 / 6.0 * p.shear, thinner - after * less
        V = (
            stiff * change[at] + still * seen[tau],
            stiff * change[at + LANES] + still * seen[tau + LANES],
        )
        put_four(change, to, (k[0] * d[0] + j[0] * u[0], k[1] * d[1] + j[1] * u[1], *V))
        tie = 0.5 * left * DRILLING * p.shear * t * (area * d[2] + more * u[2])
        change[to + 4 * LANES] = tie - less * seen[LANES * (STRESS + 14) + e]


@inlined
def relaxation(seen, change, e):
    """What yielding leaves of transverse shear, and its change over that, by what is taken."""
    left = 1.0 - seen[LANES * TAKEN + e]
    return left, change[LANES * TOOK + e] / left


@inlined
def stressed_at(change, e):
    """Changes of stresses by the names of pushes()."""
    at = LANES * STRESSED + e
    s = four(change, at + 10 * LANES)
    N, M, q = three(change, at), three(change, at + 3 * LANES), four(change, at + 6 * LANES)
    return N, M, q, (s[0], s[1]), (s[2], s[3]), change[at + 14 * LANES]


@blockwise
def push_at_rest(seen, change):
    """Forces on the corners themselves. Writes: change."""
    for e in range(LANES):
        at, row = LANES * (END + AXES) + e, LANES * PUSHED + e
        D, E, H = three(seen, row), three(seen, row + 3 * LANES), three(seen, row + 6 * LANES)
        put_corners(change, OUT, e, axes_at(seen, at), D, E, H, ZERO)


@blockwise
def push_by_turn(seen, change):
    """Change of the forces with that of the stresses. Writes: change."""
    for e in range(LANES):
        at = LANES * END + e
        (D, E, H), torque = pushes(stressed_at(change, e), geometry_at(seen, at))
        axes = axes_at(seen, at + LANES * AXES)
        put_corners(change, OUT, e, axes, D, E, H, ZERO)
        put_corners(change, OUT + 12, e, axes, *torque)


@inlined
def sum_turned(a, b, turn, f):
    """a + b + turn x f."""
    c = cross3(turn, f)
    return a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]


@inlined
def end_moved(seen, e, k, d, c, g):
    """Turn of the axes of the end, and change of the geometry there, as a corner moves."""
    at = LANES * END + e
    row = at + LANES * (AXES + k)
    n, geometry = (seen[row], seen[row + 3 * LANES], seen[row + 6 * LANES]), geometry_at(seen, at)
    D, E = times3(d, n), times3(c, n)
    turn = turn_of_axes(geometry, four(seen, at + LANES * ABOUT), D, E)
    return turn, change_of(geometry, turn, D, E, times3(g, n))


@blockwise
def push_by_place(seen, change, k, d, c, g):
    """Change of the forces as a corner moves along axis k. Writes: change."""
    for e in range(LANES):
        at = LANES * END + e
        geometry, axes = geometry_at(seen, at), axes_at(seen, at + LANES * AXES)
        turn, moved = end_moved(seen, e, k, d, c, g)
        row = LANES * PUSHED + e
        F = (three(seen, row), three(seen, row + 3 * LANES), three(seen, row + 6 * LANES))
        a, t = pushes(stressed_at(change, e), geometry)
        b, s = pushes_moved(stress_at(seen, e), F, geometry, moved)
        put_corners(
            change,
            OUT,
            e,
            axes,
            sum_turned(a[0], b[0], turn, F[0]),
            sum_turned(a[1], b[1], turn, F[1]),
            sum_turned(a[2], b[2], turn, F[2]),
            ZERO,
        )
        row += 9 * LANES
        put_corners(
            change,
            OUT + 12,
            e,
            axes,
            sum_turned(t[0], s[0], turn, three(seen, row)),
            sum_turned(t[1], s[1], turn, three(seen, row + 3 * LANES)),
            sum_turned(t[2], s[2], turn, three(seen, row + 6 * LANES)),
            sum_turned(t[3], s[3], turn, three(seen, row + 9 * LANES)),
        )
