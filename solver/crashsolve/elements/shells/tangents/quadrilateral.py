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
from crashsolve.elements.shells.plasticity import taken_modes
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
    pushes,
    pushes_moved,
    rotation_of_axes,
    spin_slopes,
    strains,
    strains_moved,
)
from crashsolve.elements.shells.tangents.records import CHANGE, FRAME, SEEN, SHEAR_IN
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import ZERO


@inlined
def put_frame(seen, at, frame, x, G):
    """Axes and geometry of an element with the diagonals x. Writes: seen."""
    axes, flat, area = frame
    put_axes(seen, at + LANES * FRAME.axes, axes)
    put_four(seen, at + LANES * FRAME.diagonals, flat)
    put_three(
        seen,
        at + LANES * FRAME.hourglass,
        (dot3(x, axes[0]), dot3(x, axes[1]), 0.25 * dot3(x, axes[2])),
    )
    seen[at + LANES * FRAME.area] = area
    put_four(seen, at + LANES * FRAME.spin, spin_slopes(flat, G))


@inlined
def geometry_at(seen, at):
    """(flat, hourglass, z, area) of a frame."""
    h_x, h_y, z = three(seen, at + LANES * FRAME.hourglass)
    return four(seen, at + LANES * FRAME.diagonals), (h_x, h_y), z, seen[at + LANES * FRAME.area]


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
    at = LANES * SEEN.stress + e
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
        geometry = geometry_at(seen, LANES * SEEN.end + e)
        (D, E, H), (t_d, t_e, t_h, t_s) = pushes(stress_at(seen, e), geometry)
        at = LANES * SEEN.pushed + e
        put_three(seen, at, D)
        put_three(seen, at + 3 * LANES, E)
        put_three(seen, at + 6 * LANES, H)
        put_three(seen, at + 9 * LANES, t_d)
        put_three(seen, at + 12 * LANES, t_e)
        put_three(seen, at + 15 * LANES, t_h)
        put_three(seen, at + 18 * LANES, t_s)


@blockwise
def see_motion(blocks, first, work, seen, h):
    """Frames of the middle and of the end, and the motion in the step. Writes: seen."""
    half = 0.5 * h
    for e in range(LANES):
        x, v, w = (
            diagonals(work, WORK.position, e),
            diagonals(work, WORK.velocity, e),
            diagonals(work, WORK.spin, e),
        )
        G = shape(blocks, first + e)
        put_frame(seen, LANES * SEEN.end + e, plane_axes(x[0], x[1], G), x[2], G)
        d, c, g = before(x[0], half, v[0]), before(x[1], half, v[1]), before(x[2], half, v[2])
        frame = plane_axes(d, c, G)
        put_frame(seen, LANES * SEEN.middle + e, frame, g, G)
        put_motions(seen, LANES * SEEN.displacement + e, frame[0], h, v)
        put_motions(seen, LANES * SEEN.rotations + e, frame[0], h, w)


@blockwise
def see_stress(blocks, kept, first, work, seen):
    """Stresses after the step, and what they were found with. Writes: seen."""
    for e in range(LANES):
        at, to = first + LANES * BLOCK.hourglass_plane + e, LANES * SEEN.stress + e
        put_three(seen, to, three(work, LANES * WORK.resultant + e))
        put_three(seen, to + 3 * LANES, three(work, LANES * WORK.moment + e))
        put_four(seen, to + 6 * LANES, four(blocks, at))
        t, shear = blocks[first + LANES * BLOCK.thickness + e], three(blocks, at + 6 * LANES)
        pair = (blocks[at + 4 * LANES], blocks[at + 5 * LANES])
        put_four(seen, to + 10 * LANES, (*pair, t * shear[0], t * shear[1]))
        seen[to + 14 * LANES] = 0.5 * shear[2]
        at = LANES * SEEN.tau + e
        seen[at], seen[at + LANES] = shear[0], shear[1]
        seen[LANES * SEEN.thickness_before + e] = kept[first + LANES * BLOCK.thickness + e]
        seen[LANES * SEEN.thickness_after + e] = t
        geometry = geometry_at(seen, LANES * SEEN.middle + e)
        _, _, q, _, change, drill = strains(
            motions_at(seen, LANES * SEEN.displacement + e),
            motions_at(seen, LANES * SEEN.rotations + e),
            geometry,
        )
        put_four(seen, LANES * SEEN.modes + e, q)
        put_three(seen, LANES * (SEEN.modes + 4) + e, (*change, drill))
        see_taken(work, seen, e)


@inlined
def see_taken(work, seen, e):
    """What yielding takes, and of what. Writes: seen."""
    seen[LANES * SEEN.taken + e], taken = work[LANES * WORK.taken + e], taken_modes(work, e)
    for m in range(4):
        # of stresses, as the tangent of the layers has them
        over = sqrt(work[LANES * (WORK.mode_square + m % 2) + e])
        seen[LANES * (SEEN.taken_modes + m) + e] = over * taken[m]
        seen[LANES * (SEEN.amplitude + m) + e] = over * work[LANES * (WORK.amplitude + m) + e]


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
def put_strains(change, e, found):
    """Writes: change."""
    d, b, q, gamma, bent, drill = found
    at = LANES * CHANGE.strain + e
    put_three(change, at, d)
    put_three(change, at + 3 * LANES, b)
    put_four(change, at + 6 * LANES, q)
    put_four(change, at + 10 * LANES, (*gamma, *bent))
    change[at + 14 * LANES] = drill


@blockwise
def strain_by_position(seen, change, b, k):
    """Change of the strains as corner b moves along axis k. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * SEEN.middle + e
        row = at + LANES * (FRAME.axes + k)
        n = (seen[row], seen[row + 3 * LANES], seen[row + 6 * LANES])
        # the middle of the step moves half as far
        half, geometry = (0.5 * n[0], 0.5 * n[1], 0.5 * n[2]), geometry_at(seen, at)
        D, E = times3(d, half), times3(c, half)
        rotation = rotation_of_axes(geometry, four(seen, at + LANES * FRAME.spin), D, E)
        moved = change_of(geometry, rotation, D, E, times3(g, half))
        u, w = (
            motions_at(seen, LANES * SEEN.displacement + e),
            motions_at(seen, LANES * SEEN.rotations + e),
        )
        du, dw = both_changed(rotation, u, n, (d, c, g, 1.0)), both_changed(rotation, w, n, NONE)
        a, b = strains(du, dw, geometry), strains_moved(u, w, geometry, moved)
        q = (a[2][0] + b[2][0], a[2][1] + b[2][1], a[2][2] + b[2][2], a[2][3] + b[2][3])
        found = (plus3(a[0], b[0]), plus3(a[1], b[1]), q, plus(a[3], b[3]), plus(a[4], b[4]))
        put_strains(change, e, (*found, a[5] + b[5]))
        put_four(change, LANES * CHANGE.moved + e, moved[0])
        change[LANES * (CHANGE.moved + 4) + e] = moved[3]


@blockwise
def strain_by_rotation(seen, change, b):
    """Change of the strains as corner b turns as `change` says. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * SEEN.middle + e
        axes, displacement = (
            axes_at(seen, at + LANES * FRAME.axes),
            three(change, LANES * CHANGE.direction + e),
        )
        n, s = (
            (dot3(axes[0], displacement), dot3(axes[1], displacement), dot3(axes[2], displacement)),
            (d, c, g, 1.0),
        )
        rotation = both_changed(ZERO, (NONE, NONE, NONE), n, s)
        put_strains(change, e, strains((NONE, NONE, NONE), rotation, geometry_at(seen, at)))
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
def enter_shear(change, e, stiff):
    """The trial transverse shear enters at a point. Writes: change."""
    at, to = LANES * (CHANGE.strain + 10) + e, LANES * (CHANGE.enters + SHEAR_IN) + e
    change[to], change[to + LANES] = stiff * change[at], stiff * change[at + LANES]


@blockwise
def stress_of_shear(seen, change, p):
    """Change of what acts on the change of shear, of V and of drilling. Writes: change."""
    for e in range(LANES):
        frame, to, at = (
            LANES * SEEN.middle + e,
            LANES * (CHANGE.stressed + 10) + e,
            LANES * (CHANGE.strain + 10) + e,
        )
        flat, area = four(seen, frame + LANES * FRAME.diagonals), seen[frame + LANES * FRAME.area]
        t = seen[LANES * SEEN.thickness_before + e]
        moved, more = four(change, LANES * CHANGE.moved + e), change[LANES * (CHANGE.moved + 4) + e]
        _, k = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
        _, j = stiffness_moved(flat, moved, area, more, p, t)
        u, d = three(seen, LANES * (SEEN.modes + 4) + e), three(change, at + 2 * LANES)
        # large strain grows the logarithm of the thickness
        thick = seen[LANES * SEEN.thickness_after + e] if p.large_strain == 1 else t
        thinner = thick * change[LANES * CHANGE.across + e] if p.thins == 1 else 0.0
        tau, after = LANES * SEEN.tau + e, seen[LANES * SEEN.thickness_after + e]
        left, less = relaxation(seen, change, e)
        stiff, still = left * after * 5.0 / 6.0 * p.shear, thinner - after * less
        V = (
            stiff * change[at] + still * seen[tau],
            stiff * change[at + LANES] + still * seen[tau + LANES],
        )
        put_four(change, to, (k[0] * d[0] + j[0] * u[0], k[1] * d[1] + j[1] * u[1], *V))
        tie = 0.5 * left * DRILLING * p.shear * t * (area * d[2] + more * u[2])
        change[to + 4 * LANES] = tie - less * seen[LANES * (SEEN.stress + 14) + e]


@inlined
def relaxation(seen, change, e):
    """What yielding leaves of transverse shear, and its change over that, by what is taken."""
    left = 1.0 - seen[LANES * SEEN.taken + e]
    return left, change[LANES * CHANGE.taken + e] / left


@inlined
def stressed_at(change, e):
    """Changes of stresses by the names of pushes()."""
    at = LANES * CHANGE.stressed + e
    s = four(change, at + 10 * LANES)
    N, M, q = three(change, at), three(change, at + 3 * LANES), four(change, at + 6 * LANES)
    return N, M, q, (s[0], s[1]), (s[2], s[3]), change[at + 14 * LANES]


@blockwise
def push_at_rest(seen, change):
    """Forces on the corners themselves. Writes: change."""
    for e in range(LANES):
        at, row = LANES * (SEEN.end + FRAME.axes) + e, LANES * SEEN.pushed + e
        D, E, H = three(seen, row), three(seen, row + 3 * LANES), three(seen, row + 6 * LANES)
        put_corners(change, CHANGE.pushed, e, axes_at(seen, at), D, E, H, ZERO)


@blockwise
def push_by_rotation(seen, change):
    """Change of the forces with that of the stresses. Writes: change."""
    for e in range(LANES):
        at = LANES * SEEN.end + e
        (D, E, H), torque = pushes(stressed_at(change, e), geometry_at(seen, at))
        axes = axes_at(seen, at + LANES * FRAME.axes)
        put_corners(change, CHANGE.pushed, e, axes, D, E, H, ZERO)
        put_corners(change, CHANGE.pushed + 12, e, axes, *torque)


@inlined
def sum_rotated(a, b, rotation, f):
    """a + b + turn x f."""
    c = cross3(rotation, f)
    return a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]


@inlined
def end_moved(seen, e, k, d, c, g):
    """Turn of the axes of the end, and change of the geometry there, as a corner moves."""
    at = LANES * SEEN.end + e
    row = at + LANES * (FRAME.axes + k)
    n, geometry = (seen[row], seen[row + 3 * LANES], seen[row + 6 * LANES]), geometry_at(seen, at)
    D, E = times3(d, n), times3(c, n)
    rotation = rotation_of_axes(geometry, four(seen, at + LANES * FRAME.spin), D, E)
    return rotation, change_of(geometry, rotation, D, E, times3(g, n))


@blockwise
def push_by_position(seen, work, change, b, k):
    """Change of the forces as corner b moves along axis k. Writes: change."""
    d, c, g = shares(b)
    for e in range(LANES):
        at = LANES * SEEN.end + e
        geometry, axes = geometry_at(seen, at), axes_at(seen, at + LANES * FRAME.axes)
        rotation, moved = end_moved(seen, e, k, d, c, g)
        row = LANES * SEEN.pushed + e
        F = (three(seen, row), three(seen, row + 3 * LANES), three(seen, row + 6 * LANES))
        a, t = pushes(stressed_at(change, e), geometry)
        b, s = pushes_moved(stress_at(seen, e), F, geometry, moved)
        put_corners(
            change,
            CHANGE.pushed,
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
            CHANGE.pushed + 12,
            e,
            axes,
            sum_rotated(t[0], s[0], rotation, three(seen, row)),
            sum_rotated(t[1], s[1], rotation, three(seen, row + 3 * LANES)),
            sum_rotated(t[2], s[2], rotation, three(seen, row + 6 * LANES)),
            sum_rotated(t[3], s[3], rotation, three(seen, row + 9 * LANES)),
        )
