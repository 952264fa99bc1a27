"""Gather and scatter of sixteen shell elements side by side: motions and forces of their corners.

Every loop over the lanes is one that the compiler turns into vector instructions: numbers lie at
equal distances, and nothing branches. `work` has a row of lanes for each number between the loops.
"""

from crashsolve.elements.shells.forces.quadrilateral import dot3
from crashsolve.elements.shells.records import BLOCK, WORK
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.lanes import EIGHT, add_forces, gather_motion
from crashsolve.foundation.motion import load_point
from crashsolve.foundation.point import LANES


@kernel
def gather(points, corners, first, work):
    """Copy positions, velocities and spins of the corners of a block. Writes: work."""
    for c in range(4):
        for e in range(0, LANES, EIGHT):
            gather_motion(
                points, corners, first + LANES * c + e, work, LANES * (WORK.position + 3 * c) + e
            )


@kernel
def record_rate(clock, number, scene, first, live, ends):
    """Shares of the corners in the squared frequencies of a block; the largest, and its element.

    Writes: clock, scene.work.
    """
    work = scene.work
    if frequency_shares(scene.lanes, first, work, ends, clock.element_rate) == 0.0:
        return
    for e in range(live):
        rate = work[LANES * WORK.rate + e]
        if rate > clock.element_rate:
            clock.element_rate, clock.limit_element = rate, number + e


@blockwise
def frequency_shares(blocks, first, work, ends, largest):
    """Squared frequencies times mass and inertia at each corner; how many are above `largest`.

    Rounded here: a product that becomes part of a sum is rounded otherwise, and sums of two threads
    must be those of one. Writes: work.
    """
    count = 0.0
    for e in range(LANES):
        rate = work[LANES * WORK.rate + e]
        load = rate * blocks[first + LANES * BLOCK.mass + e] / ends
        work[LANES * WORK.load + e] = load
        work[LANES * WORK.load + LANES + e] = load * blocks[first + LANES * BLOCK.gyration + e]
        count += 1.0 if rate > largest else 0.0
    return count


@kernel
def damped_corners(scene, corner, aside, live, ends):
    """Give corners the largest squared frequency of their damped elements.

    It is not divided among them, because half of the bound is proportional to h, not h^2. Writes:
    scene.points, scene.work.
    """
    work, points = scene.work, scene.points
    for c in range(ends):
        for e in range(live):
            at = corner + LANES * c + e
            b, target = points[scene.corners[at]], points[scene.corners[at + aside]]
            rate = work[LANES * WORK.rate + e]
            if b.mass_inv > 0.0 and b.J_inv > 0.0:
                load_point(target, rate / b.mass_inv, rate / b.J_inv, 1)
    for e in range(2 * LANES):
        work[LANES * WORK.load + e] = 0.0


@kernel
def scatter(points, corners, first, live, work, ends):
    """Add forces, torques and shares of frequency of a block to its corners. Writes: points."""
    for c in range(ends):
        for e in range(0, LANES, EIGHT):
            at = LANES * (WORK.force + 3 * c) + e
            add_forces(
                points, corners, first + LANES * c + e, work, at, LANES * WORK.load + e, live - e
            )


@inlined
def corner(work, row, c, e):
    """Vector (3,) of corner c of element e."""
    at = LANES * (row + 3 * c) + e
    return work[at], work[at + LANES], work[at + 2 * LANES]


@inlined
def diagonals(work, row, e):
    """Diagonal differences, hourglass and sum (D, E, H, S) of a vector at the corners."""
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
def put_corner(work, row, c, e, axes, u):
    """Write minus a vector of the element's axes to a corner, in world axes. Writes: work."""
    at = LANES * (row + 3 * c) + e
    for k in range(3):
        work[at + LANES * k] = -(axes[0][k] * u[0] + axes[1][k] * u[1] + axes[2][k] * u[2])


@inlined
def put_corners(work, row, e, axes, D, E, H, S):
    """Write the generalized forces on D, E, H and S as forces on the corners. Writes: work."""
    put_corner(work, row, 0, e, axes, (S[0] + H[0] - D[0], S[1] + H[1] - D[1], S[2] + H[2] - D[2]))
    put_corner(work, row, 1, e, axes, (S[0] - H[0] - E[0], S[1] - H[1] - E[1], S[2] - H[2] - E[2]))
    put_corner(work, row, 2, e, axes, (S[0] + H[0] + D[0], S[1] + H[1] + D[1], S[2] + H[2] + D[2]))
    put_corner(work, row, 3, e, axes, (S[0] - H[0] + E[0], S[1] - H[1] + E[1], S[2] - H[2] + E[2]))


@inlined
def three(column, at):
    return column[at], column[at + LANES], column[at + 2 * LANES]


@inlined
def four(column, at):
    """Four numbers of successive rows."""
    return column[at], column[at + LANES], column[at + 2 * LANES], column[at + 3 * LANES]
