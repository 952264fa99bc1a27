"""Sixteen four-node shells side by side: strains of a step, and forces on their corners."""

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
    dot3,
    hourglass_stiffness,
    plane_axes,
    rate_bound,
    shears,
    shears_transposed,
    slopes,
    slopes_transposed,
)
from crashsolve.elements.shells.records import (
    BLOCK,
    WORK,
)
from crashsolve.foundation.kernels import blockwise, inlined
from crashsolve.foundation.point import LANES


@inlined
def shape(blocks, at):
    """Inverse of the diagonals at the start."""
    return four(blocks, at + LANES * BLOCK.inverse)


@inlined
def integrate_stress(blocks, at, more, rate):
    """Add `more` to a stress; returns its mean over the step times `rate`. Writes: blocks."""
    old = blocks[at]
    blocks[at] = old + more
    return (old + 0.5 * more) * rate


@inlined
def integrate_modes(blocks, at, h, t, k, k_s, q, change):
    """Add the increments of a step to the hourglass stresses, and their work.

    Writes: blocks.
    """
    row = at + LANES * BLOCK.hourglass_plane
    q_x, q_y, p_x, p_y = q
    k_b = h * t * t / 12.0
    work_on = integrate_stress(blocks, row, h * (k[0] * q_x + k[2] * q_y), q_x)
    work_on += integrate_stress(blocks, row + LANES, h * (k[1] * q_y + k[2] * q_x), q_y)
    work_on += integrate_stress(blocks, row + 2 * LANES, k_b * (k[0] * p_x + k[2] * p_y), p_x)
    work_on += integrate_stress(blocks, row + 3 * LANES, k_b * (k[1] * p_y + k[2] * p_x), p_y)
    work_on += integrate_stress(blocks, row + 4 * LANES, h * k_s[0] * change[0], change[0])
    work_on += integrate_stress(blocks, row + 5 * LANES, h * k_s[1] * change[1], change[1])
    blocks[at + LANES * BLOCK.hourglass_work] += h * work_on


@inlined
def integrate_shear(blocks, work, first, e, x, y, tie):
    """Add the increments of a step to the transverse shear and drilling stresses.

    Writes: blocks, work.
    """
    at, to = first + LANES * BLOCK.shear + e, LANES * WORK.old_shear + e
    old_x, old_y, old = three(blocks, at)
    work[to], work[to + LANES], work[to + 2 * LANES] = old_x, old_y, old
    blocks[at], blocks[at + LANES], blocks[at + 2 * LANES] = old_x + x, old_y + y, old + tie


@inlined
def put_four(work, row, e, u):
    """Write four numbers to successive rows. Writes: work."""
    at = LANES * row + e
    work[at], work[at + LANES], work[at + 2 * LANES], work[at + 3 * LANES] = u


@blockwise
def strain(blocks, first, work, h, p):
    """Strains of a step of h, and the hourglass stresses after it, with the geometry of its middle.

    Writes: work, blocks.
    """
    E, G, nu = p.young, p.shear, p.poisson
    half = 0.5 * h
    for e in range(LANES):
        x, v = diagonals(work, WORK.position, e), diagonals(work, WORK.velocity, e)
        d, c, g = before(x[0], half, v[0]), before(x[1], half, v[1]), before(x[2], half, v[2])
        axes, flat, area = plane_axes(d, c, shape(blocks, first + e))
        hourglass, z = (dot3(g, axes[0]), dot3(g, axes[1])), 0.25 * dot3(g, axes[2])
        rotation = diagonals(work, WORK.spin, e)
        u_x, u_y, w = along(axes[0], v), along(axes[1], v), along(axes[2], v)
        t_x, t_y = along(axes[0], rotation), along(axes[1], rotation)
        # the corners lie beside the mean plane by z and -z: turning moves them along it
        xx, xy, q_x = slopes(u_x[0], u_x[1], u_x[2] - z * t_y[3], flat, hourglass, area)
        yx, yy, q_y = slopes(u_y[0], u_y[1], u_y[2] + z * t_x[3], flat, hourglass, area)
        at = LANES * WORK.membrane + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, h * yy, h * (xy + yx)
        drill = 0.5 * (yx - xy) - 0.25 * dot3(rotation[3], axes[2])
        xx, xy, p_x = slopes(t_y[0], t_y[1], t_y[2], flat, hourglass, area)
        yx, yy, p_y = slopes(-t_x[0], -t_x[1], -t_x[2], flat, hourglass, area)
        at = LANES * WORK.curvature + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, h * yy, h * (xy + yx)
        gamma, change = shears(
            w, (t_x[0], t_x[1], t_x[3]), (t_y[0], t_y[1], t_y[3]), flat, hourglass, area
        )
        t = blocks[first + LANES * BLOCK.thickness + e]
        k, k_s = hourglass_stiffness(flat, area, E, G, nu, t)
        integrate_modes(blocks, first + e, h, t, k, k_s, (q_x, q_y, p_x, p_y), change)
        shear, tie = h * 5.0 / 6.0 * G, h * DRILLING * G * t * area * drill
        integrate_shear(blocks, work, first, e, shear * gamma[0], shear * gamma[1], tie)
        work[LANES * WORK.area + e] = area
        work[LANES * WORK.depth + e] = t
        put_four(work, WORK.modes, e, (h * q_x, h * q_y, h * p_x, h * p_y))
        put_four(work, WORK.diagonals, e, flat)


@blockwise
def corner_forces(blocks, first, work, p):
    """Forces and torques on the corners from the stresses, and the bound of frequency.

    Writes: work.
    """
    for e in range(LANES):
        x = diagonals(work, WORK.position, e)
        axes, flat, area = plane_axes(x[0], x[1], shape(blocks, first + e))
        hourglass, z = (dot3(x[2], axes[0]), dot3(x[2], axes[1])), 0.25 * dot3(x[2], axes[2])
        t = blocks[first + LANES * BLOCK.thickness + e]
        N, M = three(work, LANES * WORK.resultant + e), three(work, LANES * WORK.moment + e)
        at = first + LANES * BLOCK.hourglass_plane + e
        q_x, q_y, p_x = three(blocks, at)
        p_y, s_a, s_b = three(blocks, at + 3 * LANES)
        V = (t * blocks[at + 6 * LANES], t * blocks[at + 7 * LANES])
        drill, xy = 0.5 * blocks[at + 8 * LANES], area * N[2]
        d_x, e_x, h_x = slopes_transposed(area * N[0], xy - drill, q_x, flat, hourglass, area)
        d_y, e_y, h_y = slopes_transposed(xy + drill, area * N[1], q_y, flat, hourglass, area)
        w, t_x, t_y = shears_transposed(V, (s_a, s_b), flat, hourglass)
        zero = (0.0, 0.0, 0.0)
        put_corners(
            work, WORK.force, e, axes, (d_x, d_y, w[0]), (e_x, e_y, w[1]), (h_x, h_y, w[2]), zero
        )
        m_d, m_e, m_h = slopes_transposed(area * M[0], area * M[2], p_x, flat, hourglass, area)
        n_d, n_e, n_h = slopes_transposed(area * M[2], area * M[1], p_y, flat, hourglass, area)
        put_corners(
            work,
            WORK.torque,
            e,
            axes,
            (t_x[0] - n_d, t_y[0] + m_d, 0.0),
            (t_x[1] - n_e, t_y[1] + m_e, 0.0),
            (-n_h, m_h, 0.0),
            (t_x[2] + z * h_y, t_y[2] - z * h_x, -0.5 * drill),
        )
        at = first + LANES * BLOCK.gyration + e
        light = p.plane * t * area / blocks[at + LANES]
        work[LANES * WORK.rate + e] = rate_bound(
            flat, hourglass, z, area, t, blocks[at], light, p.poisson
        )
