"""Tangent of the three-node shell: its forces by motions of its corners, as of the four-node shell.

    dG = dw_j - dw_i + s . (dbeta_i + dbeta_j) / 2 + ds . (beta_i + beta_j) / 2

of a side s, and the slopes of the plane as those of a quadrilateral whose fourth corner is the
third: without an hourglass. Consequence to test: central differences of the forces.

References: those of elements/triangle.py and layers.py.
"""

from crashsolve.elements.shells.forces.corners import before, four, put_corner, three
from crashsolve.elements.shells.forces.quadrilateral import DRILLING, dot3, plane_axes
from crashsolve.elements.shells.forces.quadrilateral_block import shape
from crashsolve.elements.shells.forces.triangle import CORNERS as CORNERS
from crashsolve.elements.shells.forces.triangle import (
    circulation_stiffness,
    of_corners,
    shear_factor_of,
    triangle_diagonals,
)
from crashsolve.elements.shells.forces.triangle import span as span
from crashsolve.elements.shells.forces.triangle import strain as strain
from crashsolve.elements.shells.hourglass_return import relax_shear, set_trial_shear
from crashsolve.elements.shells.layers import reset_growth, update_elements
from crashsolve.elements.shells.records import BLOCK, WORK
from crashsolve.elements.shells.tangents.columns import (
    axes_at,
    put_four,
    put_three,
    respond,
    set_strain_changes,
)
from crashsolve.elements.shells.tangents.layers import layers_of_one_point
from crashsolve.elements.shells.tangents.quadrilateral import (
    both_changed,
    end_moved,
    geometry_at,
    motions_at,
    put_frame,
    relaxation,
    set_relaxation,
    sum_rotated,
    times3,
)
from crashsolve.elements.shells.tangents.quadrilateral_moved import (
    NONE,
    change_of,
    rotation_of_axes,
)
from crashsolve.elements.shells.tangents.records import (
    ACROSS_OUT,
    BASE,
    CHANGE,
    FRAME,
    SHEAR_IN,
    TAKEN_OUT,
)
from crashsolve.elements.shells.tangents.triangle_moved import (
    generalized_forces,
    pushes_moved,
    side_changes,
    strains,
    strains_moved,
    stress_of,
)
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.foundation.vec3 import ZERO

DAMPING = LANES * BASE.points


@kernel
def stress(first, stride, h, p, scene, material):
    """Stresses of a block after a step of h [s], and the tangents of its layers.

    Writes: scene.lanes, work, seen.
    """
    blocks, work = scene.lanes, scene.work
    reset_growth(work)
    set_trial_shear(blocks, first, work)
    layers_of_one_point(first, h, p, scene, material)
    relax_shear(blocks, first, work, p)
    update_elements(blocks, first, stride, work, h, p)


@inlined
def shares(b):
    """Shares of corner b in D and E."""
    return b - 1.0, 0.5 * b * (3.0 * b - 5.0)


@blockwise
def set_base(blocks, blocks_before, first, work, base, h):
    """Both frames, the motion of the step and the stresses after it; `blocks_before` is from
    before it.

    Writes: base.
    """
    set_motion(blocks, first, work, base, h)
    for e in range(LANES):
        to, at = LANES * BASE.stress + e, first + e
        put_three(base, to, three(work, LANES * WORK.resultant + e))
        put_three(base, to + 3 * LANES, three(work, LANES * WORK.moment + e))
        t, tau = blocks[at + LANES * BLOCK.thickness], LANES * BASE.tau + e
        x, y = blocks[at + LANES * BLOCK.shear], blocks[at + LANES * (BLOCK.shear + 1)]
        put_four(base, to + 6 * LANES, (blocks[at + LANES * BLOCK.hourglass_plane], 0.0, 0.0, 0.0))
        put_four(base, to + 10 * LANES, (0.0, 0.0, t * x, t * y))
        base[to + 14 * LANES] = 0.5 * blocks[at + LANES * BLOCK.drilling]
        base[tau], base[tau + LANES] = x, y
        base[LANES * BASE.thickness_before + e], base[LANES * BASE.thickness_after + e] = (
            blocks_before[at + LANES * BLOCK.thickness],
            t,
        )
        u, rotation = (
            motions_at(base, LANES * BASE.displacement + e),
            motions_at(base, LANES * BASE.rotations + e),
        )
        _, _, others = strains(u, rotation, geometry_at(base, LANES * BASE.middle + e))
        put_four(base, LANES * BASE.modes + e, others)
        set_relaxation(work, base, e)
    for e in range(LANES):
        forces, torques = generalized_forces(
            stress_at(base, e), geometry_at(base, LANES * BASE.end + e)
        )
        at = LANES * BASE.mode_actions + e
        for c in range(3):
            put_three(base, at + 3 * c * LANES, forces[c])
            put_three(base, at + (9 + 3 * c) * LANES, torques[c])


@inlined
def put_corners_of(base, at, axes, h, a, b, c):
    """h times three vectors along the axes, and no fourth. Writes: base."""
    for k in range(3):
        x, y, z = dot3(a, axes[k]), dot3(b, axes[k]), dot3(c, axes[k])
        put_four(base, at + 4 * LANES * k, (h * x, h * y, h * z, 0.0))


@blockwise
def set_motion(blocks, first, work, base, h):
    """Frames of the middle and of the end, and the motion in the step. Writes: base."""
    half = 0.5 * h
    for e in range(LANES):
        G, w = shape(blocks, first + e), of_corners(work, WORK.spin, e)
        d, c = triangle_diagonals(of_corners(work, WORK.position, e))
        v_d, v_c = triangle_diagonals(of_corners(work, WORK.velocity, e))
        put_frame(base, LANES * BASE.end + e, plane_axes(d, c, G), ZERO, G)
        frame = plane_axes(before(d, half, v_d), before(c, half, v_c), G)
        put_frame(base, LANES * BASE.middle + e, frame, ZERO, G)
        put_corners_of(base, LANES * BASE.displacement + e, frame[0], h, v_d, v_c, ZERO)
        put_corners_of(base, LANES * BASE.rotations + e, frame[0], h, w[0], w[1], w[2])


@inlined
def put_strains(change, e, a, b):
    """The sum of two changes of strains. Writes: change."""
    (d, bent, others), (d_moved, bent_moved, others_moved) = a, b
    at = LANES * CHANGE.strain + e
    for k in range(3):
        change[at + LANES * k] = d[k] + d_moved[k]
        change[at + LANES * (3 + k)] = bent[k] + bent_moved[k]
    for k in range(4):
        change[at + LANES * (6 + k)] = others[k] + others_moved[k]


@blockwise
def strain_by_position(base, change, b, k):
    """Change of the strains as corner b moves along axis k. Writes: change."""
    d, c = shares(b)
    for e in range(LANES):
        at = LANES * BASE.middle + e
        row = at + LANES * (FRAME.axes + k)
        n = (base[row], base[row + 3 * LANES], base[row + 6 * LANES])
        # the middle of the step moves half as far
        geometry = geometry_at(base, at)
        D, E = times3(0.5 * d, n), times3(0.5 * c, n)
        rotation = rotation_of_axes(geometry, four(base, at + LANES * FRAME.spin), D, E)
        moved = change_of(geometry, rotation, D, E, ZERO)
        u, w = (
            motions_at(base, LANES * BASE.displacement + e),
            motions_at(base, LANES * BASE.rotations + e),
        )
        du, dw = both_changed(rotation, u, n, (d, c, 0.0, 0.0)), both_changed(rotation, w, n, NONE)
        put_strains(change, e, strains(du, dw, geometry), strains_moved(u, w, geometry, moved))
        put_four(change, LANES * CHANGE.moved + e, moved[0])
        change[LANES * (CHANGE.moved + 4) + e] = moved[3]


@blockwise
def strain_by_rotation(base, change, b):
    """Change of the strains as corner b turns by `change`. Writes: change."""
    s = (0.5 * (b - 1.0) * (b - 2.0), b * (2.0 - b), 0.5 * b * (b - 1.0), 0.0)
    for e in range(LANES):
        at = LANES * BASE.middle + e
        axes, displacement = (
            axes_at(base, at + LANES * FRAME.axes),
            three(change, LANES * CHANGE.direction + e),
        )
        n = (dot3(axes[0], displacement), dot3(axes[1], displacement), dot3(axes[2], displacement))
        rotation = both_changed(ZERO, (NONE, NONE, NONE), n, s)
        changes = strains((NONE, NONE, NONE), rotation, geometry_at(base, at))
        put_strains(change, e, changes, (ZERO, ZERO, NONE))
        put_four(change, LANES * CHANGE.moved + e, NONE)
        change[LANES * (CHANGE.moved + 4) + e] = 0.0


@blockwise
def stress_by(base, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    set_strain_changes(change)
    for e in range(LANES):
        tau = LANES * (CHANGE.point_strain + SHEAR_IN) + e
        change[tau], change[tau + LANES] = shear_by(base, change, e, p)
    respond(base, LANES * BASE.points, change)
    for row in range(6 * LANES):
        change[LANES * CHANGE.stressed + row] = change[LANES * CHANGE.point_stress + row]
    for e in range(LANES):
        change[LANES * CHANGE.relaxed + e] = change[LANES * (CHANGE.point_stress + TAKEN_OUT) + e]
        shear_and_tie_by(base, change, e, p)


@inlined
def shear_by(base, change, e, p):
    """Change of the trial transverse shear."""
    s, t, weaker, _ = side_changes(base, change, e)
    k = 5.0 / 6.0 * p.shear * shear_factor_of(s, t)
    u, du = four(base, LANES * BASE.modes + e), four(change, LANES * (CHANGE.strain + 6) + e)
    return k * (du[0] + weaker * u[0]), k * (du[1] + weaker * u[1])


@inlined
def shear_and_tie_by(base, change, e, p):
    """Set the changes of circulation, transverse shear and drilling. Writes: change."""
    s, t, weaker, wider = side_changes(base, change, e)
    area, to = geometry_at(base, LANES * BASE.middle + e)[3], LANES * CHANGE.stressed + e
    more, after = change[LANES * (CHANGE.moved + 4) + e], base[LANES * BASE.thickness_after + e]
    u, du = four(base, LANES * BASE.modes + e), four(change, LANES * (CHANGE.strain + 6) + e)
    k = t * circulation_stiffness(s, area, t, p.shear)
    Q = k * (du[2] + (weaker + wider - more / area) * u[2])
    put_four(change, to + 6 * LANES, (Q, 0.0, 0.0, 0.0))
    # large strain grows the logarithm of the thickness
    across = change[LANES * (CHANGE.point_stress + ACROSS_OUT) + e]
    thinner = (after if p.large_strain == 1 else t) * across if p.thins == 1 else 0.0
    left, less = relaxation(base, change, e)
    still, tau, trial = (
        thinner - after * less,
        LANES * BASE.tau + e,
        LANES * (CHANGE.point_strain + SHEAR_IN) + e,
    )
    V_x = after * left * change[trial] + still * base[tau]
    V_y = after * left * change[trial + LANES] + still * base[tau + LANES]
    put_four(change, to + 10 * LANES, (0.0, 0.0, V_x, V_y))
    drill = 0.5 * left * DRILLING * p.shear * t * (area * du[3] + more * u[3])
    change[to + 14 * LANES] = drill - less * base[LANES * (BASE.stress + 14) + e]


@inlined
def stress_at(base, e):
    """Stresses after the step."""
    return stress_of(base, LANES * BASE.stress + e)


@blockwise
def corner_forces_by_stress(base, change):
    """Forces on the corners themselves. Writes: change."""
    for e in range(LANES):
        axes, row = (
            axes_at(base, LANES * (BASE.end + FRAME.axes) + e),
            LANES * BASE.mode_actions + e,
        )
        for c in range(3):
            put_corner(change, CHANGE.mode_actions, c, e, axes, three(base, row + 3 * c * LANES))


@blockwise
def corner_forces_by_rotation(base, change):
    """Change of the forces with that of the stresses. Writes: change."""
    for e in range(LANES):
        at = LANES * BASE.end + e
        forces, torques = generalized_forces(
            stress_of(change, LANES * CHANGE.stressed + e), geometry_at(base, at)
        )
        axes = axes_at(base, at + LANES * FRAME.axes)
        for c in range(3):
            put_corner(change, CHANGE.mode_actions, c, e, axes, forces[c])
            put_corner(change, CHANGE.mode_actions + 12, c, e, axes, torques[c])


@blockwise
def corner_forces_by_position(base, work, change, b, k):
    """Change of the forces as corner b moves along axis k. Writes: change."""
    d, c = shares(b)
    for e in range(LANES):
        at, row = LANES * BASE.end + e, LANES * BASE.mode_actions + e
        geometry, axes = geometry_at(base, at), axes_at(base, at + LANES * FRAME.axes)
        rotation, moved = end_moved(base, e, k, d, c, 0.0)
        f, t = generalized_forces(stress_of(change, LANES * CHANGE.stressed + e), geometry)
        F, T = pushes_moved(stress_at(base, e), geometry, moved)
        for j in range(3):
            own = three(base, row + 3 * j * LANES), three(base, row + (9 + 3 * j) * LANES)
            put_corner(
                change, CHANGE.mode_actions, j, e, axes, sum_rotated(f[j], F[j], rotation, own[0])
            )
            put_corner(
                change,
                CHANGE.mode_actions + 12,
                j,
                e,
                axes,
                sum_rotated(t[j], T[j], rotation, own[1]),
            )
