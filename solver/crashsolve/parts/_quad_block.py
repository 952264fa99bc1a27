"""Sixteen four-node shells side by side: gather their nodes, strain them, push their nodes.

Every loop over the lanes is one that the compiler turns into vector instructions: numbers lie at
equal distances, and nothing branches. `work` has a row of lanes for each number between the loops.
"""

from crashsolve.foundation.compile import blockwise, inlined, kernel
from crashsolve.foundation.lanes import EIGHT, add_forces, take_motion
from crashsolve.foundation.motion import load_point
from crashsolve.foundation.point import LANES
from crashsolve.parts._quad import (
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

# rows of a block: of every element, then of its layers
THICKNESS, SHAPE, RADIUS_2, WEIGHT, LOSS, PLANE_Q, BEND_Q, SHEAR_Q, SHEAR, DRILL = (
    *(0, 1, 5, 6, 7, 8, 10, 12, 14, 16),
)
# work on the hourglass
HOURGLASS, LAYERS = 17, 18
# rows of `work`: places, velocities and spins of the corners; afterwards their forces and torques
PLACE, VELOCITY, SPIN = 0, 12, 24
FORCE, TORQUE = 0, 12
# strains of the step: of the plane, curvatures, shear; resultants; squared frequency
MEMBRANE, CURVATURE, RESULTANT, MOMENT, RATE, AREA, DEPTH = 36, 39, 42, 45, 48, 49, 50
# of the step: what differs from a linear field, of the plane and of the turns; diagonals
MODES, FLAT = 51, 55
# transverse shear stress, and that of the tie of spins, before the step
HELD = 59
ROWS = 62
# when all that is done: squared frequency times mass, and times inertia
LOAD = MODES


@kernel
def gather(points, corners, first, work):
    """Places, velocities and spins of the corners of a block. Writes: work."""
    for c in range(4):
        for e in range(0, LANES, EIGHT):
            take_motion(points, corners, first + LANES * c + e, work, LANES * (PLACE + 3 * c) + e)


@kernel
def note_rate(clock, number, scene, first, live, ends):
    """Shares of the corners in the squared frequencies of a block; the largest, and whose it is.

    Writes: clock, scene.work.
    """
    work = scene.work
    if weigh(scene.lanes, first, work, ends, clock.element_rate) == 0.0:
        return
    for e in range(live):
        rate = work[LANES * RATE + e]
        if rate > clock.element_rate:
            clock.element_rate, clock.limit_element = rate, number + e


@blockwise
def weigh(blocks, first, work, ends, largest):
    """Squared frequencies times mass and inertia at each corner; how many are above `largest`.

    Rounded here: a product that becomes part of a sum is rounded otherwise, and sums of two threads
    must be those of one. Writes: work.
    """
    count = 0.0
    for e in range(LANES):
        rate = work[LANES * RATE + e]
        load = rate * blocks[first + LANES * WEIGHT + e] / ends
        work[LANES * LOAD + e] = load
        work[LANES * LOAD + LANES + e] = load * blocks[first + LANES * RADIUS_2 + e]
        count += 1.0 if rate > largest else 0.0
    return count


@kernel
def slow_corners(scene, corner, live, ends):
    """Squared frequencies of elements with damping to their corners, which keep the largest.

    They share nothing out: half of what they need grows with h, not h^2. Writes: scene.points,
    scene.work.
    """
    work, points = scene.work, scene.points
    for c in range(ends):
        for e in range(live):
            b = points[scene.corners[corner + LANES * c + e]]
            rate = work[LANES * RATE + e]
            if b.mass_inv > 0.0 and b.J_inv > 0.0:
                load_point(b, rate / b.mass_inv, rate / b.J_inv, 1)
    for e in range(2 * LANES):
        work[LANES * LOAD + e] = 0.0


@kernel
def scatter(points, corners, first, live, work, ends):
    """Forces, torques and shares of frequency of a block onto its corners. Writes: points."""
    for c in range(ends):
        for e in range(0, LANES, EIGHT):
            at = LANES * (FORCE + 3 * c) + e
            add_forces(points, corners, first + LANES * c + e, work, at, LANES * LOAD + e, live - e)


@inlined
def corner(work, row, c, e):
    """Vector of a corner."""
    at = LANES * (row + 3 * c) + e
    return work[at], work[at + LANES], work[at + 2 * LANES]


@inlined
def diagonals(work, row, e):
    """(D, E, H, S) of a vector at the corners."""
    u1, u2 = corner(work, row, 0, e), corner(work, row, 1, e)
    u3, u4 = corner(work, row, 2, e), corner(work, row, 3, e)
    odd = (u1[0] + u3[0], u1[1] + u3[1], u1[2] + u3[2])
    even = (u2[0] + u4[0], u2[1] + u4[1], u2[2] + u4[2])
    return (
        (u3[0] - u1[0], u3[1] - u1[1], u3[2] - u1[2]),
        (u4[0] - u2[0], u4[1] - u2[1], u4[2] - u2[2]),
        (odd[0] - even[0], odd[1] - even[1], odd[2] - even[2]),
        (odd[0] + even[0], odd[1] + even[1], odd[2] + even[2]),
    )


@inlined
def along(axis, u):
    """Components of (D, E, H, S) along an axis."""
    return dot3(u[0], axis), dot3(u[1], axis), dot3(u[2], axis), dot3(u[3], axis)


@inlined
def before(x, half, u):
    """x - half u."""
    return x[0] - half * u[0], x[1] - half * u[1], x[2] - half * u[2]


@inlined
def shape(blocks, at):
    """Inverse of the diagonals at the start."""
    return four(blocks, at + LANES * SHAPE)


@inlined
def grow(blocks, at, more, rate):
    """Let a stress grow; its mean over the step times what it works on. Writes: blocks."""
    old = blocks[at]
    blocks[at] = old + more
    return (old + 0.5 * more) * rate


@inlined
def grow_modes(blocks, at, h, t, k, k_s, q, change):
    """Hourglass stresses after a step, by the rates of what one point does not see.

    Writes: blocks.
    """
    row = at + LANES * PLANE_Q
    q_x, q_y, p_x, p_y = q
    k_b = h * t * t / 12.0
    work_on = grow(blocks, row, h * (k[0] * q_x + k[2] * q_y), q_x)
    work_on += grow(blocks, row + LANES, h * (k[1] * q_y + k[2] * q_x), q_y)
    work_on += grow(blocks, row + 2 * LANES, k_b * (k[0] * p_x + k[2] * p_y), p_x)
    work_on += grow(blocks, row + 3 * LANES, k_b * (k[1] * p_y + k[2] * p_x), p_y)
    work_on += grow(blocks, row + 4 * LANES, h * k_s[0] * change[0], change[0])
    work_on += grow(blocks, row + 5 * LANES, h * k_s[1] * change[1], change[1])
    blocks[at + LANES * HOURGLASS] += h * work_on


@inlined
def grow_held(blocks, work, first, e, x, y, tie):
    """Let transverse shear, and the stress that ties spins to the plane, grow.

    Writes: blocks, work.
    """
    at, to = first + LANES * SHEAR + e, LANES * HELD + e
    old_x, old_y, old = three(blocks, at)
    work[to], work[to + LANES], work[to + 2 * LANES] = old_x, old_y, old
    blocks[at], blocks[at + LANES], blocks[at + 2 * LANES] = old_x + x, old_y + y, old + tie


@inlined
def put_four(work, row, e, u):
    """Four numbers in rows one after the other. Writes: work."""
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
        x, v = diagonals(work, PLACE, e), diagonals(work, VELOCITY, e)
        d, c, g = before(x[0], half, v[0]), before(x[1], half, v[1]), before(x[2], half, v[2])
        axes, flat, area = plane_axes(d, c, shape(blocks, first + e))
        hourglass, z = (dot3(g, axes[0]), dot3(g, axes[1])), 0.25 * dot3(g, axes[2])
        turn = diagonals(work, SPIN, e)
        u_x, u_y, w = along(axes[0], v), along(axes[1], v), along(axes[2], v)
        t_x, t_y = along(axes[0], turn), along(axes[1], turn)
        # the corners lie beside the mean plane by z and -z: turning moves them along it
        xx, xy, q_x = slopes(u_x[0], u_x[1], u_x[2] - z * t_y[3], flat, hourglass, area)
        yx, yy, q_y = slopes(u_y[0], u_y[1], u_y[2] + z * t_x[3], flat, hourglass, area)
        at = LANES * MEMBRANE + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, h * yy, h * (xy + yx)
        drill = 0.5 * (yx - xy) - 0.25 * dot3(turn[3], axes[2])
        xx, xy, p_x = slopes(t_y[0], t_y[1], t_y[2], flat, hourglass, area)
        yx, yy, p_y = slopes(-t_x[0], -t_x[1], -t_x[2], flat, hourglass, area)
        at = LANES * CURVATURE + e
        work[at], work[at + LANES], work[at + 2 * LANES] = h * xx, h * yy, h * (xy + yx)
        gamma, change = shears(
            w, (t_x[0], t_x[1], t_x[3]), (t_y[0], t_y[1], t_y[3]), flat, hourglass, area
        )
        t = blocks[first + LANES * THICKNESS + e]
        k, k_s = hourglass_stiffness(flat, area, E, G, nu, t)
        grow_modes(blocks, first + e, h, t, k, k_s, (q_x, q_y, p_x, p_y), change)
        shear, tie = h * 5.0 / 6.0 * G, h * DRILLING * G * t * area * drill
        grow_held(blocks, work, first, e, shear * gamma[0], shear * gamma[1], tie)
        work[LANES * AREA + e] = area
        work[LANES * DEPTH + e] = t
        put_four(work, MODES, e, (h * q_x, h * q_y, h * p_x, h * p_y))
        put_four(work, FLAT, e, flat)


@inlined
def put_corner(work, row, c, e, axes, u):
    """Minus a vector in the element's axes at a corner. Writes: work."""
    at = LANES * (row + 3 * c) + e
    for k in range(3):
        work[at + LANES * k] = -(axes[0][k] * u[0] + axes[1][k] * u[1] + axes[2][k] * u[2])


@inlined
def put_corners(work, row, e, axes, D, E, H, S):
    """What acts on D, E, H and S as forces on the corners. Writes: work."""
    put_corner(work, row, 0, e, axes, (S[0] + H[0] - D[0], S[1] + H[1] - D[1], S[2] + H[2] - D[2]))
    put_corner(work, row, 1, e, axes, (S[0] - H[0] - E[0], S[1] - H[1] - E[1], S[2] - H[2] - E[2]))
    put_corner(work, row, 2, e, axes, (S[0] + H[0] + D[0], S[1] + H[1] + D[1], S[2] + H[2] + D[2]))
    put_corner(work, row, 3, e, axes, (S[0] - H[0] + E[0], S[1] - H[1] + E[1], S[2] - H[2] + E[2]))


@inlined
def three(column, at):
    return column[at], column[at + LANES], column[at + 2 * LANES]


@inlined
def four(column, at):
    """Numbers of four rows one after the other."""
    return column[at], column[at + LANES], column[at + 2 * LANES], column[at + 3 * LANES]


@blockwise
def push(blocks, first, work, p):
    """Forces and torques on the corners from the stresses, and the bound of frequency.

    Writes: work.
    """
    for e in range(LANES):
        x = diagonals(work, PLACE, e)
        axes, flat, area = plane_axes(x[0], x[1], shape(blocks, first + e))
        hourglass, z = (dot3(x[2], axes[0]), dot3(x[2], axes[1])), 0.25 * dot3(x[2], axes[2])
        t = blocks[first + LANES * THICKNESS + e]
        N, M = three(work, LANES * RESULTANT + e), three(work, LANES * MOMENT + e)
        at = first + LANES * PLANE_Q + e
        q_x, q_y, p_x = three(blocks, at)
        p_y, s_a, s_b = three(blocks, at + 3 * LANES)
        V = (t * blocks[at + 6 * LANES], t * blocks[at + 7 * LANES])
        drill, xy = 0.5 * blocks[at + 8 * LANES], area * N[2]
        d_x, e_x, h_x = slopes_transposed(area * N[0], xy - drill, q_x, flat, hourglass, area)
        d_y, e_y, h_y = slopes_transposed(xy + drill, area * N[1], q_y, flat, hourglass, area)
        w, t_x, t_y = shears_transposed(V, (s_a, s_b), flat, hourglass)
        zero = (0.0, 0.0, 0.0)
        put_corners(
            work, FORCE, e, axes, (d_x, d_y, w[0]), (e_x, e_y, w[1]), (h_x, h_y, w[2]), zero
        )
        m_d, m_e, m_h = slopes_transposed(area * M[0], area * M[2], p_x, flat, hourglass, area)
        n_d, n_e, n_h = slopes_transposed(area * M[2], area * M[1], p_y, flat, hourglass, area)
        put_corners(
            work,
            TORQUE,
            e,
            axes,
            (t_x[0] - n_d, t_y[0] + m_d, 0.0),
            (t_x[1] - n_e, t_y[1] + m_e, 0.0),
            (-n_h, m_h, 0.0),
            (t_x[2] + z * h_y, t_y[2] - z * h_x, -0.5 * drill),
        )
        at = first + LANES * RADIUS_2 + e
        light = p.plane * t * area / blocks[at + LANES]
        work[LANES * RATE + e] = rate_bound(
            flat, hourglass, z, area, t, blocks[at], light, p.poisson
        )
