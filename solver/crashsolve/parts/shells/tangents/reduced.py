"""Tangent of the four-node shell with one point in its plane: columns of all its motions.

    K = B_end^T (C B_mid + (dC) S) + (dB_end)^T sigma

as quadrilateral.py has it, with the hourglass stresses that yield with the layers. Consequence to
test: central differences of the forces give the same, in large turns and beyond yield.

References: those of quadrilateral.py.
"""

from math import sqrt

from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES
from crashsolve.parts.shells.damping import damp
from crashsolve.parts.shells.elements.corners import four, gather
from crashsolve.parts.shells.elements.quadrilateral import hourglass_stiffness, sides
from crashsolve.parts.shells.elements.quadrilateral_block import strain
from crashsolve.parts.shells.hourglass_return import (
    clear_weak,
    mode_sizes,
    relax_modes,
    relax_shear,
    see_modes,
    see_shear,
)
from crashsolve.parts.shells.layers import take_up
from crashsolve.parts.shells.records import BLOCK
from crashsolve.parts.shells.resultants import clear_resultants
from crashsolve.parts.shells.tangents.columns import (
    add_column,
    add_damping,
    enter_strains,
    put_four,
    respond,
    shares,
    turn_arms,
    turn_corner,
)
from crashsolve.parts.shells.tangents.layers import layers_and_tangent
from crashsolve.parts.shells.tangents.quadrilateral import (
    enter_shear,
    push_at_rest,
    push_by_place,
    push_by_turn,
    see,
    stiffness_moved,
    strain_by_place,
    strain_by_turn,
    stress_of_shear,
)
from crashsolve.parts.shells.tangents.records import (
    ACROSS_OUT,
    CHANGE,
    FRAME,
    MODES_IN,
    SEEN,
    TAKEN_OUT,
)


@kernel
def tangent(p, h, scene, matrix, material):
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
        at = first + LANES * BLOCK.SIZE
        layers_and_tangent(
            blocks,
            scene.lanes_before,
            at,
            work,
            seen,
            LANES * SEEN.points,
            h,
            p,
            scene.curves,
            material,
        )
        relax_modes(blocks, first, work)
        relax_shear(blocks, first, work, p)
        take_up(blocks, first, p.stride, work, h, p)
        if p.slows == 1:
            damp(blocks, first, p.stride, work, h, p)
            add_damping(seen, LANES * SEEN.points, work, h, p)
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


@blockwise
def stress_by(seen, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    enter_strains(change)
    for e in range(LANES):
        modes_by(seen, change, e, p)
        enter_shear(change, e, 5.0 / 6.0 * p.shear)
    respond(seen, LANES * SEEN.points, change)
    for row in range(6 * LANES):
        change[LANES * CHANGE.stressed + row] = change[LANES * CHANGE.comes + row]
    for e in range(LANES):
        change[LANES * CHANGE.taken + e] = change[LANES * (CHANGE.comes + TAKEN_OUT) + e]
        change[LANES * CHANGE.across + e] = change[LANES * (CHANGE.comes + ACROSS_OUT) + e]
        relax_modes_by(seen, change, e)
    stress_of_shear(seen, change, p)


@inlined
def sizes_at(seen, change, e):
    """r_x and r_y of the middle, and their change."""
    flat = four(seen, LANES * (SEEN.middle + FRAME.diagonals) + e)
    (a_x, a_y, b_x, b_y), moved = sides(flat), sides(four(change, LANES * CHANGE.moved + e))
    x, y = mode_sizes(flat)
    r_x, r_y = sqrt(x), sqrt(y)
    d_x = 4.0 / 3.0 * (a_y * moved[1] + b_y * moved[3]) / r_x
    d_y = 4.0 / 3.0 * (a_x * moved[0] + b_x * moved[2]) / r_y
    return (r_x, r_y), (d_x, d_y)


@inlined
def modes_by(seen, change, e, p):
    """Change of the trial stresses of the modes; their amplitudes enter. Writes: change."""
    frame, to, at = (
        LANES * SEEN.middle + e,
        LANES * (CHANGE.stressed + 6) + e,
        LANES * (CHANGE.strain + 6) + e,
    )
    flat, area, t = (
        four(seen, frame + LANES * FRAME.diagonals),
        seen[frame + LANES * FRAME.area],
        seen[LANES * SEEN.thickness_before + e],
    )
    moved, more = four(change, LANES * CHANGE.moved + e), change[LANES * (CHANGE.moved + 4) + e]
    k, _ = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    j, _ = stiffness_moved(flat, moved, area, more, p, t)
    u, d, bend = four(seen, LANES * SEEN.modes + e), four(change, at), t * t / 12.0
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
        amplitude = seen[LANES * (SEEN.amplitude + m) + e]
        change[LANES * (CHANGE.enters + MODES_IN + m) + e] = over * Q[m] - share * amplitude


@inlined
def relax_modes_by(seen, change, e):
    """What yielding takes of the change of the stresses of the modes. Writes: change."""
    t, (sizes, grow) = seen[LANES * SEEN.thickness_before + e], sizes_at(seen, change, e)
    for m in range(4):
        taken = seen[LANES * (SEEN.taken_modes + m) + e]
        more = change[LANES * (CHANGE.comes + MODES_IN + m) + e]
        less = t * (grow[m % 2] * taken + sizes[m % 2] * more)
        change[LANES * (CHANGE.stressed + 6 + m) + e] -= less
