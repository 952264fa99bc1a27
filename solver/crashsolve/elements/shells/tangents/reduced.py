"""Tangent of the four-node shell with one point in its plane: columns of all its motions.

    K = B_end^T (C B_mid + (dC) S) + (dB_end)^T sigma

as quadrilateral.py has it, with the hourglass stresses that yield with the layers. Consequence to
test: central differences of the forces give the same, in large rotations and beyond yield.

References: those of quadrilateral.py.
"""

from math import sqrt

from crashsolve.elements.shells.forces.corners import four
from crashsolve.elements.shells.forces.quadrilateral import hourglass_stiffness, sides
from crashsolve.elements.shells.forces.reduced import CORNERS as CORNERS
from crashsolve.elements.shells.forces.reduced import span as span
from crashsolve.elements.shells.forces.reduced import strain as strain
from crashsolve.elements.shells.hourglass_return import (
    mode_sizes,
    relax_modes,
    relax_shear,
    set_trial_modes,
    set_trial_shear,
)
from crashsolve.elements.shells.layers import update_elements
from crashsolve.elements.shells.tangents.columns import put_four, respond, set_strain_changes
from crashsolve.elements.shells.tangents.layers import layers_of_one_point
from crashsolve.elements.shells.tangents.quadrilateral import (
    corner_forces_by_position as corner_forces_by_position,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    corner_forces_by_rotation as corner_forces_by_rotation,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    corner_forces_by_stress as corner_forces_by_stress,
)
from crashsolve.elements.shells.tangents.quadrilateral import set_base as set_base
from crashsolve.elements.shells.tangents.quadrilateral import (
    set_shear_changes,
    stiffness_moved,
    stress_of_shear,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    strain_by_position as strain_by_position,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    strain_by_rotation as strain_by_rotation,
)
from crashsolve.elements.shells.tangents.records import (
    ACROSS_OUT,
    BASE,
    CHANGE,
    FRAME,
    MODES_IN,
    TAKEN_OUT,
)
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES

DAMPING = LANES * BASE.points


@kernel
def stress(first, stride, h, p, scene, material):
    """Stresses of a block after a step of h [s], and the tangents of its layers.

    Writes: scene.lanes, work, seen.
    """
    blocks, work = scene.lanes, scene.work
    set_trial_shear(blocks, first, work)
    set_trial_modes(blocks, first, work)
    layers_of_one_point(first, h, p, scene, material)
    relax_modes(blocks, first, work)
    relax_shear(blocks, first, work, p)
    update_elements(blocks, first, stride, work, h, p)


@blockwise
def stress_by(base, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    set_strain_changes(change)
    for e in range(LANES):
        modes_by(base, change, e, p)
        set_shear_changes(change, e, 5.0 / 6.0 * p.shear)
    respond(base, LANES * BASE.points, change)
    for row in range(6 * LANES):
        change[LANES * CHANGE.stressed + row] = change[LANES * CHANGE.point_stress + row]
    for e in range(LANES):
        change[LANES * CHANGE.relaxed + e] = change[LANES * (CHANGE.point_stress + TAKEN_OUT) + e]
        change[LANES * CHANGE.across + e] = change[LANES * (CHANGE.point_stress + ACROSS_OUT) + e]
        relax_modes_by(base, change, e)
    stress_of_shear(base, change, p)


@inlined
def sizes_at(base, change, e):
    """r_x and r_y of the middle, and their change."""
    flat = four(base, LANES * (BASE.middle + FRAME.diagonals) + e)
    (a_x, a_y, b_x, b_y), moved = sides(flat), sides(four(change, LANES * CHANGE.moved + e))
    x, y = mode_sizes(flat)
    r_x, r_y = sqrt(x), sqrt(y)
    d_x = 4.0 / 3.0 * (a_y * moved[1] + b_y * moved[3]) / r_x
    d_y = 4.0 / 3.0 * (a_x * moved[0] + b_x * moved[2]) / r_y
    return (r_x, r_y), (d_x, d_y)


@inlined
def modes_by(base, change, e, p):
    """Change of the trial stresses of the modes; their amplitudes enter. Writes: change."""
    frame, to, at = (
        LANES * BASE.middle + e,
        LANES * (CHANGE.stressed + 6) + e,
        LANES * (CHANGE.strain + 6) + e,
    )
    flat, area, t = (
        four(base, frame + LANES * FRAME.diagonals),
        base[frame + LANES * FRAME.area],
        base[LANES * BASE.thickness_before + e],
    )
    moved, more = four(change, LANES * CHANGE.moved + e), change[LANES * (CHANGE.moved + 4) + e]
    k, _ = hourglass_stiffness(flat, area, p.young, p.shear, p.poisson, t)
    j, _ = stiffness_moved(flat, moved, area, more, p, t)
    u, d, bend = four(base, LANES * BASE.modes + e), four(change, at), t * t / 12.0
    Q = (
        k[0] * d[0] + k[2] * d[1] + j[0] * u[0] + j[2] * u[1],
        k[1] * d[1] + k[2] * d[0] + j[1] * u[1] + j[2] * u[0],
        bend * (k[0] * d[2] + k[2] * d[3] + j[0] * u[2] + j[2] * u[3]),
        bend * (k[1] * d[3] + k[2] * d[2] + j[1] * u[3] + j[2] * u[2]),
    )
    put_four(change, to, Q)
    sizes, size_changes = sizes_at(base, change, e)
    for m in range(4):
        over = (1.0 if m < 2 else 1.0 / bend) / (t * sizes[m % 2])
        share = size_changes[m % 2] / sizes[m % 2]
        amplitude = base[LANES * (BASE.amplitude + m) + e]
        change[LANES * (CHANGE.point_strain + MODES_IN + m) + e] = over * Q[m] - share * amplitude


@inlined
def relax_modes_by(base, change, e):
    """Relax the changes of the stresses of the modes by yielding. Writes: change."""
    t, (sizes, size_changes) = (
        base[LANES * BASE.thickness_before + e],
        sizes_at(base, change, e),
    )
    for m in range(4):
        relaxed = base[LANES * (BASE.relaxed_modes + m) + e]
        more = change[LANES * (CHANGE.point_stress + MODES_IN + m) + e]
        less = t * (size_changes[m % 2] * relaxed + sizes[m % 2] * more)
        change[LANES * (CHANGE.stressed + 6 + m) + e] -= less
