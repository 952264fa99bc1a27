"""Four-node shell with 2 by 2 points in its plane: the strains of bending in the plane at each.

    eps_x = eps_x0 + h_x q_x - nu h_y q_y,   eps_y = eps_y0 + h_y q_y - nu h_x q_x
    h_x, h_y the slopes of xi eta,   q the part of the motion in the plane beyond a linear field

and likewise the curvatures, with q of the rotations. Shear is that of the middle, so that bending
in the plane costs none; transverse shear is assumed from the sides, and elastic. In an elastic
element the sum over the points is, exactly, the stiffness that the element of one point has
instead; beyond yield every point has its own stress, and no motion is left to a stiffness of its
own. Consequence to test: elastic forces are those of the element with one point.

References: Belytschko and Bindeman (1991), Assumed strain stabilization of the 4-node quadrilateral
with 1-point quadrature for nonlinear problems, Computer Methods in Applied Mechanics and
Engineering 88, 311-340. Dvorkin and Bathe (1984), A continuum mechanics based four-node shell
element for general nonlinear analysis, Engineering Computations 1, 77-88.
"""

from crashsolve.elements.shells.energies import (
    drilling_energy,
    in_plane,
    layer_energy,
    shear_energy,
    twist_energy,
)
from crashsolve.elements.shells.forces import quadrilateral_block
from crashsolve.elements.shells.forces.blocks import span_of_quadrilaterals
from crashsolve.elements.shells.forces.corners import diagonals, four
from crashsolve.elements.shells.forces.quadrilateral import plane_axes, sides
from crashsolve.elements.shells.forces.quadrilateral_block import shape
from crashsolve.elements.shells.forces.quadrilateral_block import strain as strain
from crashsolve.elements.shells.hourglass_return import relax_shear, set_trial_shear
from crashsolve.elements.shells.layers import reset_growth, through_thickness, update_elements
from crashsolve.elements.shells.records import BLOCK, WORK
from crashsolve.elements.shells.resultants import clear_resultants
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES

CORNERS, POINTS = 4, 4
POSITION_OF_POINT = 3.0**-0.5


@kernel
def span(p):
    """The Span of these elements in a part."""
    return span_of_quadrilaterals(p, p.four_points)


@kernel
def corner_forces(blocks, first, work, p):
    """Forces and torques on the corners from the stresses. Writes: blocks, work."""
    mode_forces(blocks, first, work)
    quadrilateral_block.corner_forces(blocks, first, work, p)


@blockwise
def stress(blocks, first, stride, work, h, p, curves, material):
    """Stresses at all points after a step of h, and the means of their resultants.

    Writes: blocks, work.
    """
    keep_mean(work)
    if p.yields == 1:
        set_trial_shear(blocks, first, work)
    if p.large_strain == 1:
        reset_growth(work)
    count = 0
    for point in range(4):
        xi, eta = natural_coordinates(point)
        strain_at(work, xi, eta, p.poisson)
        clear_resultants(work)
        at = first + LANES * (BLOCK.SIZE + point * p.layers * p.layer_rows)
        count += through_thickness(blocks, at, work, h, p, curves, material)
        add_point(work, xi, eta, p.poisson)
    put_sums(work)
    if count > 0:
        relax_shear(blocks, first, work, p)
    update_elements(blocks, first, stride, work, h, p)


@inlined
def natural_coordinates(point):
    """xi and eta of a point."""
    xi = POSITION_OF_POINT if point == 1 or point == 2 else -POSITION_OF_POINT
    return xi, POSITION_OF_POINT if point > 1 else -POSITION_OF_POINT


@blockwise
def keep_mean(work):
    """Store the strains of the middle, and clear the sums over points. Writes: work."""
    for row in range(6 * LANES):
        work[LANES * WORK.middle + row] = work[LANES * WORK.membrane + row]
    for row in range(18 * LANES):
        work[LANES * WORK.sums + row] = 0.0


@blockwise
def put_sums(work):
    """Put sums over the points in the place of the values of one point. Writes: work."""
    for row in range(6 * LANES):
        work[LANES * WORK.resultant + row] = work[LANES * WORK.sums + row]
        work[LANES * WORK.membrane + row] = work[LANES * WORK.middle + row]
    for e in range(LANES):
        work[LANES * WORK.thinning + e] = work[LANES * WORK.mean_thinning + e]
        work[LANES * WORK.lost + e] = work[LANES * WORK.mean_lost + e]
        work[LANES * WORK.dropped + e] = work[LANES * WORK.mean_dropped + e]
        work[LANES * WORK.relaxed + e] = work[LANES * WORK.mean_relaxed + e]


@inlined
def slopes_at(flat, xi, eta):
    """Slopes of xi eta times the area, at a point, with the axes xi and eta of the middle."""
    a_x, a_y, b_x, b_y = sides(flat)
    return 2.0 * (eta * b_y - xi * a_y), 2.0 * (xi * a_x - eta * b_x)


@blockwise
def strain_at(work, xi, eta, nu):
    """Strains and curvatures of the step at a point. Writes: work."""
    for e in range(LANES):
        flat = four(work, LANES * WORK.diagonals + e)
        h_x, h_y = slopes_at(flat, xi, eta)
        a_x, a_y, b_x, b_y = sides(flat)
        over = 1.0 / (a_x * b_y - a_y * b_x)
        h_x, h_y = over * h_x, over * h_y
        for pair in range(2):
            mode, mean = LANES * (WORK.modes + 2 * pair) + e, LANES * (WORK.middle + 3 * pair) + e
            x, y = h_x * work[mode], h_y * work[mode + LANES]
            at = LANES * (WORK.membrane + 3 * pair) + e
            work[at] = work[mean] + x - nu * y
            work[at + LANES] = work[mean + LANES] + y - nu * x
            work[at + 2 * LANES] = work[mean + 2 * LANES]


@blockwise
def add_point(work, xi, eta, nu):
    """Add a quarter of the values at a point to the sums. Writes: work."""
    for e in range(LANES):
        for k in range(6):
            work[LANES * (WORK.sums + k) + e] += 0.25 * work[LANES * (WORK.resultant + k) + e]
        for pair in range(2):
            at, to = LANES * (WORK.resultant + 3 * pair) + e, LANES * (WORK.xi_eta + 4 * pair) + e
            x, y = work[at] - nu * work[at + LANES], work[at + LANES] - nu * work[at]
            work[to] += 0.25 * xi * x
            work[to + LANES] += 0.25 * eta * x
            work[to + 2 * LANES] += 0.25 * xi * y
            work[to + 3 * LANES] += 0.25 * eta * y
        work[LANES * WORK.mean_thinning + e] += 0.25 * work[LANES * WORK.thinning + e]
        work[LANES * WORK.mean_lost + e] += 0.25 * work[LANES * WORK.lost + e]
        work[LANES * WORK.mean_dropped + e] += 0.25 * work[LANES * WORK.dropped + e]
        work[LANES * WORK.mean_relaxed + e] += 0.25 * work[LANES * WORK.relaxed + e]


@blockwise
def mode_forces(blocks, first, work):
    """Forces conjugate to q: the transpose of the strains at the points, in the configuration after
    the step.

    Writes: blocks.
    """
    for e in range(LANES):
        x = diagonals(work, WORK.position, e)
        _, flat, _ = plane_axes(x[0], x[1], shape(blocks, first + e))
        for pair in range(2):
            at = LANES * (WORK.xi_eta + 4 * pair) + e
            # slopes are linear in xi and eta
            q_x, _ = slopes_at(flat, work[at], work[at + LANES])
            _, q_y = slopes_at(flat, work[at + 2 * LANES], work[at + 3 * LANES])
            to = first + LANES * (BLOCK.hourglass_plane + 2 * pair) + e
            blocks[to], blocks[to + LANES] = q_x, q_y


@kernel
def element_energy(p, blocks, at, d, e, material):
    """Elastic energy of the layers and of transverse shear, none of hourglass, drilling [J]."""
    t, flat, area = in_plane(blocks, at, d, e)
    total = shear_energy(p, blocks, at)
    for point in range(4):
        row = at + LANES * (BLOCK.SIZE + point * p.layers * p.layer_rows)
        total += 0.25 * layer_energy(p, blocks, row, material)
    stored = area * t * total + twist_energy(p, blocks, at, t, flat, area)
    return stored, 0.0, drilling_energy(p, blocks, at, t, area)
