"""Tangent of the four-node shell with 2 by 2 points in its plane: motions as with one point.

    d eps_x = d eps_x0 + h_x dq_x + dh_x q_x - nu (h_y dq_y + dh_y q_y)

at each point, with the tangent of its own layers; the action on q is summed over the points with
the slopes h of the end of the step. Consequence to test: central differences of the forces.

References: those of elements/full.py and layers.py.
"""

from crashsolve.elements.shells.forces.corners import four, three
from crashsolve.elements.shells.forces.full import CORNERS as CORNERS
from crashsolve.elements.shells.forces.full import (
    add_point,
    keep_mean,
    mode_forces,
    natural_coordinates,
    put_sums,
    slopes_at,
    strain_at,
)
from crashsolve.elements.shells.forces.full import span as span
from crashsolve.elements.shells.forces.full import strain as strain
from crashsolve.elements.shells.hourglass_return import relax_shear, set_trial_shear
from crashsolve.elements.shells.layers import update_elements
from crashsolve.elements.shells.records import BLOCK, WORK
from crashsolve.elements.shells.resultants import clear_resultants
from crashsolve.elements.shells.tangents import quadrilateral
from crashsolve.elements.shells.tangents.columns import (
    put_three,
    respond,
    set_strain_changes,
    shares,
)
from crashsolve.elements.shells.tangents.layers import clear_tangent, layers_and_tangent
from crashsolve.elements.shells.tangents.quadrilateral import (
    corner_forces_by_rotation as corner_forces_by_rotation,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    corner_forces_by_stress as corner_forces_by_stress,
)
from crashsolve.elements.shells.tangents.quadrilateral import (
    end_moved,
    geometry_at,
    set_shear_changes,
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
    BENDING,
    CHANGE,
    POINT_ROWS,
    TAKEN_OUT,
)
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES

DAMPING = LANES * (BASE.points + 4 * POINT_ROWS)


@kernel
def stress(first, stride, h, p, scene, material):
    """Stresses of a block after a step of h [s], and the tangents of its layers at all points.

    Writes: scene.lanes, work, seen.
    """
    blocks, work, base = scene.lanes, scene.work, scene.base
    keep_mean(work)
    set_trial_shear(blocks, first, work)
    for point in range(4):
        xi, eta = natural_coordinates(point)
        strain_at(work, xi, eta, p.poisson)
        clear_resultants(work)
        at = first + LANES * (BLOCK.SIZE + point * p.layers * p.layer_rows)
        layers_and_tangent(at, LANES * (BASE.points + point * POINT_ROWS), h, p, scene, material)
        add_point(work, xi, eta, p.poisson)
    put_sums(work)
    relax_shear(blocks, first, work, p)
    update_elements(blocks, first, stride, work, h, p)
    clear_tangent(base, DAMPING)


@kernel
def set_base(blocks, blocks_before, first, work, base, h):
    """Set the forces on q, and the state as of elements with one point. Writes: blocks, base."""
    mode_forces(blocks, first, work)
    quadrilateral.set_base(blocks, blocks_before, first, work, base, h)


@blockwise
def stress_by(base, change, p):
    """Change of the stresses with that of strains and geometry. Writes: change."""
    set_strain_changes(change)
    respond(base, DAMPING, change)
    for row in range(6 * LANES):
        change[LANES * CHANGE.stressed + row] = change[LANES * CHANGE.point_stress + row]
    for e in range(LANES):
        set_shear_changes(change, e, 5.0 / 6.0 * p.shear)
        change[LANES * CHANGE.across + e] = change[LANES * CHANGE.relaxed + e] = 0.0
        for k in range(8):
            change[LANES * (CHANGE.sums + k) + e] = 0.0
    for point in range(4):
        xi, eta = natural_coordinates(point)
        add_point_by(base, change, LANES * (BASE.points + point * POINT_ROWS), xi, eta, p.poisson)
    stress_of_shear(base, change, p)
    mode_forces_by(base, change)


@inlined
def strains_by(base, change, e, pair, h, dh, nu):
    """Change of the strains, or curvatures, at a point with the slopes h."""
    q, dq = LANES * (BASE.modes + 2 * pair) + e, LANES * (CHANGE.strain + 6 + 2 * pair) + e
    x = h[0] * change[dq] + dh[0] * base[q]
    y = h[1] * change[dq + LANES] + dh[1] * base[q + LANES]
    d = three(change, LANES * (CHANGE.strain + 3 * pair) + e)
    return d[0] + x - nu * y, d[1] + y - nu * x, d[2]


@blockwise
def add_point_by(base, change, entry, xi, eta, nu):
    """Add a quarter of the changes at a point to the sums. Writes: change."""
    for e in range(LANES):
        flat, _, _, area = geometry_at(base, LANES * BASE.middle + e)
        at = LANES * CHANGE.moved + e
        moved, share = four(change, at), change[at + 4 * LANES] / area
        h, dh = slopes_at(flat, xi, eta), slopes_at(moved, xi, eta)
        h = (h[0] / area, h[1] / area)
        dh = (dh[0] / area - share * h[0], dh[1] / area - share * h[1])
        put_three(
            change, LANES * CHANGE.point_strain + e, strains_by(base, change, e, 0, h, dh, nu)
        )
        bent = strains_by(base, change, e, 1, h, dh, nu)
        put_three(change, LANES * (CHANGE.point_strain + BENDING) + e, bent)
    respond(base, entry, change)
    for e in range(LANES):
        change[LANES * CHANGE.relaxed + e] += (
            0.25 * change[LANES * (CHANGE.point_stress + TAKEN_OUT) + e]
        )
        change[LANES * CHANGE.across + e] += (
            0.25 * change[LANES * (CHANGE.point_stress + ACROSS_OUT) + e]
        )
        for pair in range(2):
            s = three(change, LANES * (CHANGE.point_stress + BENDING * pair) + e)
            at, to = LANES * (CHANGE.stressed + 3 * pair) + e, LANES * (CHANGE.sums + 4 * pair) + e
            for k in range(3):
                change[at + LANES * k] += 0.25 * s[k]
            x, y = 0.25 * (s[0] - nu * s[1]), 0.25 * (s[1] - nu * s[0])
            change[to] += xi * x
            change[to + LANES] += eta * x
            change[to + 2 * LANES] += xi * y
            change[to + 3 * LANES] += eta * y


@inlined
def mode_actions(flat, sums):
    """Generalized forces on q along x and y, from sums over the points."""
    x, _ = slopes_at(flat, sums[0], sums[1])
    _, y = slopes_at(flat, sums[2], sums[3])
    return x, y


@blockwise
def mode_forces_by(base, change):
    """Set the change of the forces on the modes from that of the sums. Writes: change."""
    for e in range(LANES):
        flat, to = geometry_at(base, LANES * BASE.end + e)[0], LANES * (CHANGE.stressed + 6) + e
        for pair in range(2):
            x, y = mode_actions(flat, four(change, LANES * (CHANGE.sums + 4 * pair) + e))
            change[to + 2 * LANES * pair], change[to + LANES * (2 * pair + 1)] = x, y


@kernel
def corner_forces_by_position(base, work, change, b, k):
    """Change of the forces as corner b moves along axis k. Writes: change."""
    mode_forces_moved(base, work, change, b, k)
    quadrilateral.corner_forces_by_position(base, work, change, b, k)


@blockwise
def mode_forces_moved(base, work, change, b, k):
    """Add the change of the forces on q by the geometry of the end as a corner moves.

    Writes: change.
    """
    d, c, g = shares(b)
    for e in range(LANES):
        _, moved = end_moved(base, e, k, d, c, g)
        to = LANES * (CHANGE.stressed + 6) + e
        for pair in range(2):
            x, y = mode_actions(moved[0], four(work, LANES * (WORK.xi_eta + 4 * pair) + e))
            change[to + 2 * LANES * pair] += x
            change[to + LANES * (2 * pair + 1)] += y
