"""Tangent of four-node shells: their forces by motions of their corners.

    K = B_end^T (C B_mid + (dC) S) + (dB_end)^T sigma,   C with the tangent of the layers' return

in columns, one for each motion of each corner, sixteen elements side by side. Strains are those of
the middle of the step and forces those of its end: K is not symmetric. Consequence to test: central
differences of the forces give the same, in large rotations and beyond yield.

References: those of elements/quadrilateral.py and layers.py.
"""

from math import sqrt

from crashsolve.elements.shells.forces.corners import (
    along,
    before,
    diagonals,
    four,
    put_corners,
    three,
)
from crashsolve.elements.shells.forces.quadrilateral import (
    DRILLING,
    cross3,
    dot3,
    hourglass_stiffness,
    plane_axes,
    sides,
)
from crashsolve.elements.shells.forces.quadrilateral_block import shape
from crashsolve.elements.shells.plasticity import relaxed_modes
from crashsolve.elements.shells.records import (
    BLOCK,
    WORK,
)
from crashsolve.elements.shells.tangents.columns import (
    axes_at,
    put_axes,
    put_four,
    put_three,
    shares,
)
from crashsolve.elements.shells.tangents.quadrilateral_moved import (
    NONE,
    change_of,
    generalized_forces,
    pushes_moved,
    rotation_of_axes,
    spin_slopes,
    strains,
    strains_moved,
)
from crashsolve.elements.shells.tangents.records import BASE, CHANGE, FRAME, SHEAR_IN
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import ZERO


@inlined
def put_frame(base, at, frame, x, G):
    """Set axes and geometry of an element with the diagonals x. Writes: base."""
    axes, flat, area = frame
    put_axes(base, at + LANES * FRAME.axes, axes)
    put_four(base, at + LANES * FRAME.diagonals, flat)
    put_three(
        base,
        at + LANES * FRAME.hourglass,
        (dot3(x, axes[0]), dot3(x, axes[1]), 0.25 * dot3(x, axes[2])),
    )
    base[at + LANES * FRAME.area] = area
    put_four(base, at + LANES * FRAME.spin, spin_slopes(flat, G))


@inlined
def geometry_at(base, at):
    """(flat, hourglass, z, area) of a frame."""
    h_x, h_y, z = three(base, at + LANES * FRAME.hourglass)
    return four(base, at + LANES * FRAME.diagonals), (h_x, h_y), z, base[at + LANES * FRAME.area]


@inlined
def motions_at(base, at):
    """x, y and z of (D, E, H, S)."""
    return four(base, at), four(base, at + 4 * LANES), four(base, at + 8 * LANES)


@inlined
def put_motions(base, at, axes, h, u):
    """h u along the axes. Writes: base."""
    for k in range(3):
        x = along(axes[k], u)
        put_four(base, at + 4 * LANES * k, (h * x[0], h * x[1], h * x[2], h * x[3]))


@inlined
def stress_at(base, e):
    """Stresses by the names of pushes()."""
    at = LANES * BASE.stress + e
    q, s = four(base, at + 6 * LANES), four(base, at + 10 * LANES)
    pairs = (s[0], s[1]), (s[2], s[3])
    return three(base, at), three(base, at + 3 * LANES), q, *pairs, base[at + 14 * LANES]


@blockwise
def set_base(blocks, blocks_before, first, work, base, h):
    """Set frames, motion and stresses of the step; `blocks_before` are the blocks before it.

    Writes: base.
    """
    set_motion(blocks, first, work, base, h)
    set_stress(blocks, blocks_before, first, work, base)
    for e in range(LANES):
        geometry = geometry_at(base, LANES * BASE.end + e)
        (D, E, H), (t_d, t_e, t_h, t_s) = generalized_forces(stress_at(base, e), geometry)
        at = LANES * BASE.mode_actions + e
        put_three(base, at, D)
        put_three(base, at + 3 * LANES, E)
        put_three(base, at + 6 * LANES, H)
        put_three(base, at + 9 * LANES, t_d)
        put_three(base, at + 12 * LANES, t_e)
        put_three(base, at + 15 * LANES, t_h)
        put_three(base, at + 18 * LANES, t_s)


@blockwise
def set_motion(blocks, first, work, base, h):
    """Set the frames of middle and end, and the motion of the step. Writes: base."""
    half = 0.5 * h
    for e in range(LANES):
        x, v, w = (
            diagonals(work, WORK.position, e),
            diagonals(work, WORK.velocity, e),
            diagonals(work, WORK.spin, e),
        )
        G = shape(blocks, first + e)
        put_frame(base, LANES * BASE.end + e, plane_axes(x[0], x[1], G), x[2], G)
        d, c, g = before(x[0], half, v[0]), before(x[1], half, v[1]), before(x[2], half, v[2])
        frame = plane_axes(d, c, G)
        put_frame(base, LANES * BASE.middle + e, frame, g, G)
        put_motions(base, LANES * BASE.displacement + e, frame[0], h, v)
        put_motions(base, LANES * BASE.rotations + e, frame[0], h, w)


@blockwise
def set_stress(blocks, blocks_before, first, work, base):
    """Set the stresses after the step, and the quantities they depend on. Writes: base."""
    for e in range(LANES):
        at, to = first + LANES * BLOCK.hourglass_plane + e, LANES * BASE.stress + e
        put_three(base, to, three(work, LANES * WORK.resultant + e))
        put_three(base, to + 3 * LANES, three(work, LANES * WORK.moment + e))
        put_four(base, to + 6 * LANES, four(blocks, at))
        t, shear = blocks[first + LANES * BLOCK.thickness + e], three(blocks, at + 6 * LANES)
        pair = (blocks[at + 4 * LANES], blocks[at + 5 * LANES])
        put_four(base, to + 10 * LANES, (*pair, t * shear[0], t * shear[1]))
        base[to + 14 * LANES] = 0.5 * shear[2]
        at = LANES * BASE.tau + e
        base[at], base[at + LANES] = shear[0], shear[1]
        base[LANES * BASE.thickness_before + e] = blocks_before[first + LANES * BLOCK.thickness + e]
        base[LANES * BASE.thickness_after + e] = t
        geometry = geometry_at(base, LANES * BASE.middle + e)
        _, _, q, _, change, drill = strains(
            motions_at(base, LANES * BASE.displacement + e),
            motions_at(base, LANES * BASE.rotations + e),
            geometry,
        )
        put_four(base, LANES * BASE.modes + e, q)
        put_three(base, LANES * (BASE.modes + 4) + e, (*change, drill))
        set_relaxation(work, base, e)


@inlined
def set_relaxation(work, base, e):
    """Set the relaxation by yielding, and the trial stresses. Writes: base."""
    base[LANES * BASE.relaxed + e], relaxed = work[LANES * WORK.relaxed + e], relaxed_modes(work, e)
    for m in range(4):
        # of stresses, as the tangent of the layers has them
        over = sqrt(work[LANES * (WORK.mode_square + m % 2) + e])
        base[LANES * (BASE.relaxed_modes + m) + e] = over * relaxed[m]
        base[LANES * (BASE.amplitude + m) + e] = over * work[LANES * (WORK.amplitude + m) + e]


@inlined
def both_changed(rotation, u, n, s):
    """Change of (x, y, z) of (D, E, H, S), axes turning, as corners move by n with shares s."""
    x, y, z = u
    return (
        grown(n[0], s, rotation[2], y, -rotation[1], z),
        grown(n[1], s, rotation[0], z, -rotation[2], x),
        grown(n[2], s, rotation[1], x, -rotation[0], y),
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
def put_strains(change, e, changes):
    """Writes: change."""
    d, b, q, gamma, bent, drill = changes
    at = LANES * CHANGE.strain + e
    put_three(change, at, d)
    put_three(change, at + 3 * LANES, b)
    put_four(change, at + 6 * LANES, q)
    put_four(change, at + 10 * LANES, (*gamma, *bent))
    change[at + 14 * LANES] = drill


@blockwise
def strain_by_position(base, change, b, k):
    """Change of the strains as corner b moves along axis k. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * BASE.middle + e
        row = at + LANES * (FRAME.axes + k)
        n = (base[row], base[row + 3 * LANES], base[row + 6 * LANES])
        # the middle of the step moves half as far
        half, geometry = (0.5 * n[0], 0.5 * n[1], 0.5 * n[2]), geometry_at(base, at)
        D, E = times3(d, half), times3(c, half)
        rotation = rotation_of_axes(geometry, four(base, at + LANES * FRAME.spin), D, E)
        moved = change_of(geometry, rotation, D, E, times3(g, half))
        u, w = (
            motions_at(base, LANES * BASE.displacement + e),
            motions_at(base, LANES * BASE.rotations + e),
        )
        du, dw = both_changed(rotation, u, n, (d, c, g, 1.0)), both_changed(rotation, w, n, NONE)
        a, b = strains(du, dw, geometry), strains_moved(u, w, geometry, moved)
        q = (a[2][0] + b[2][0], a[2][1] + b[2][1], a[2][2] + b[2][2], a[2][3] + b[2][3])
        changes = (plus3(a[0], b[0]), plus3(a[1], b[1]), q, plus(a[3], b[3]), plus(a[4], b[4]))
        put_strains(change, e, (*changes, a[5] + b[5]))
        put_four(change, LANES * CHANGE.moved + e, moved[0])
        change[LANES * (CHANGE.moved + 4) + e] = moved[3]


@blockwise
def strain_by_rotation(base, change, b):
    """Change of the strains as corner b turns by `change`. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * BASE.middle + e
        axes, displacement = (
            axes_at(base, at + LANES * FRAME.axes),
            three(change, LANES * CHANGE.direction + e),
        )
        n, s = (
            (dot3(axes[0], displacement), dot3(axes[1], displacement), dot3(axes[2], displacement)),
            (d, c, g, 1.0),
        )
        rotation = both_changed(ZERO, (NONE, NONE, NONE), n, s)
        put_strains(change, e, strains((NONE, NONE, NONE), rotation, geometry_at(base, at)))
        put_four(change, LANES * CHANGE.moved + e, NONE)
        change[LANES * (CHANGE.moved + 4) + e] = 0.0


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


@inlined
def set_shear_changes(change, e, stiff):
    """Set the change of the trial transverse shear at a point. Writes: change."""
    at, to = LANES * (CHANGE.strain + 10) + e, LANES * (CHANGE.point_strain + SHEAR_IN) + e
    change[to], change[to + LANES] = stiff * change[at], stiff * change[at + LANES]


@blockwise
def stress_of_shear(base, change, p):
    """Set the changes of the forces on the change of shear, of V and of drilling.

    Writes: change.
    """
    for e in range(LANES):
        frame, to, at = (
            LANES * BASE.middle + e,
            LANES * (CHANGE.stressed + 10) + e,
            LANES * (CHANGE.strain + 10) + e,
        )
        flat, area = four(base, frame + LANES * FRAME.diagonals), base[frame + LANES * FRAME.area]
        t = base[LANES * BASE.thickness_before + e]
        moved, more = four(change, LANES * CHANGE.moved + e), change[LANES * (CHANGE.moved + 4) + e]
        _, k = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
        _, j = stiffness_moved(flat, moved, area, more, p, t)
        u, d = three(base, LANES * (BASE.modes + 4) + e), three(change, at + 2 * LANES)
        # large strain grows the logarithm of the thickness
        thick = base[LANES * BASE.thickness_after + e] if p.large_strain == 1 else t
        thinner = thick * change[LANES * CHANGE.across + e] if p.thins == 1 else 0.0
        tau, after = LANES * BASE.tau + e, base[LANES * BASE.thickness_after + e]
        left, less = relaxation(base, change, e)
        stiff, still = left * after * 5.0 / 6.0 * p.shear, thinner - after * less
        V = (
            stiff * change[at] + still * base[tau],
            stiff * change[at + LANES] + still * base[tau + LANES],
        )
        put_four(change, to, (k[0] * d[0] + j[0] * u[0], k[1] * d[1] + j[1] * u[1], *V))
        tie = 0.5 * left * DRILLING * p.shear * t * (area * d[2] + more * u[2])
        change[to + 4 * LANES] = tie - less * base[LANES * (BASE.stress + 14) + e]


@inlined
def relaxation(base, change, e):
    """Transverse shear after relaxation over the trial one, and the relative change of that."""
    left = 1.0 - base[LANES * BASE.relaxed + e]
    return left, change[LANES * CHANGE.relaxed + e] / left


@inlined
def stressed_at(change, e):
    """Changes of stresses by the names of pushes()."""
    at = LANES * CHANGE.stressed + e
    s = four(change, at + 10 * LANES)
    N, M, q = three(change, at), three(change, at + 3 * LANES), four(change, at + 6 * LANES)
    return N, M, q, (s[0], s[1]), (s[2], s[3]), change[at + 14 * LANES]


@blockwise
def corner_forces_by_stress(base, change):
    """Set the forces on the corners by the present stresses. Writes: change."""
    for e in range(LANES):
        at, row = LANES * (BASE.end + FRAME.axes) + e, LANES * BASE.mode_actions + e
        D, E, H = three(base, row), three(base, row + 3 * LANES), three(base, row + 6 * LANES)
        put_corners(change, CHANGE.mode_actions, e, axes_at(base, at), D, E, H, ZERO)


@blockwise
def corner_forces_by_rotation(base, change):
    """Change of the forces with that of the stresses. Writes: change."""
    for e in range(LANES):
        at = LANES * BASE.end + e
        (D, E, H), torque = generalized_forces(stressed_at(change, e), geometry_at(base, at))
        axes = axes_at(base, at + LANES * FRAME.axes)
        put_corners(change, CHANGE.mode_actions, e, axes, D, E, H, ZERO)
        put_corners(change, CHANGE.mode_actions + 12, e, axes, *torque)


@inlined
def sum_rotated(a, b, rotation, f):
    """a + b + turn x f."""
    c = cross3(rotation, f)
    return a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]


@inlined
def end_moved(base, e, k, d, c, g):
    """Rotation of the axes of the end, and change of its geometry, as a corner moves."""
    at = LANES * BASE.end + e
    row = at + LANES * (FRAME.axes + k)
    n, geometry = (base[row], base[row + 3 * LANES], base[row + 6 * LANES]), geometry_at(base, at)
    D, E = times3(d, n), times3(c, n)
    rotation = rotation_of_axes(geometry, four(base, at + LANES * FRAME.spin), D, E)
    return rotation, change_of(geometry, rotation, D, E, times3(g, n))


@blockwise
def corner_forces_by_position(base, work, change, b, k):
    """Change of the forces as corner b moves along axis k. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * BASE.end + e
        geometry, axes = geometry_at(base, at), axes_at(base, at + LANES * FRAME.axes)
        rotation, moved = end_moved(base, e, k, d, c, g)
        row = LANES * BASE.mode_actions + e
        F = (three(base, row), three(base, row + 3 * LANES), three(base, row + 6 * LANES))
        a, t = generalized_forces(stressed_at(change, e), geometry)
        b, s = pushes_moved(stress_at(base, e), F, geometry, moved)
        put_corners(
            change,
            CHANGE.mode_actions,
            e,
            axes,
            sum_rotated(a[0], b[0], rotation, F[0]),
            sum_rotated(a[1], b[1], rotation, F[1]),
            sum_rotated(a[2], b[2], rotation, F[2]),
            ZERO,
        )
        row += 9 * LANES
        put_corners(
            change,
            CHANGE.mode_actions + 12,
            e,
            axes,
            sum_rotated(t[0], s[0], rotation, three(base, row)),
            sum_rotated(t[1], s[1], rotation, three(base, row + 3 * LANES)),
            sum_rotated(t[2], s[2], rotation, three(base, row + 6 * LANES)),
            sum_rotated(t[3], s[3], rotation, three(base, row + 9 * LANES)),
        )
