"""Common functions of the tangents of shells: rows of numbers, corner rotations, blocks of the
matrix.

A tangent is made for sixteen elements at a time, a column for every motion of every corner: data
common to all columns are `base`, those of the present one are its `change`. A corner with
the Cayley vector c of the step, which turns by dtheta at its end, has

    2 dc = dtheta + dtheta x c + (c . dtheta) c

Consequence to test: the columns are derivatives of the forces.
"""

from crashsolve.elements.shells.forces.corners import three
from crashsolve.elements.shells.forces.quadrilateral import cross3, dot3
from crashsolve.elements.shells.records import WORK
from crashsolve.elements.shells.tangents.records import BENDING, CHANGE, SIDE
from crashsolve.foundation.kernels import blockwise, inlined, kernel
from crashsolve.foundation.point import LANES


@inlined
def put_three(table, at, u):
    """Writes: table."""
    table[at], table[at + LANES], table[at + 2 * LANES] = u[0], u[1], u[2]


@inlined
def put_four(table, at, u):
    """Writes: table."""
    table[at], table[at + LANES] = u[0], u[1]
    table[at + 2 * LANES], table[at + 3 * LANES] = u[2], u[3]


@inlined
def axes_at(base, at):
    """Axes of a frame."""
    return three(base, at), three(base, at + 3 * LANES), three(base, at + 6 * LANES)


@inlined
def put_axes(base, at, axes):
    """Writes: base."""
    put_three(base, at, axes[0])
    put_three(base, at + 3 * LANES, axes[1])
    put_three(base, at + 6 * LANES, axes[2])


@inlined
def shares(b):
    """Derivatives of D, E and H by corner b."""
    odd = b % 2
    return (1 - odd) * (b - 1.0), odd * (b - 2.0), 1.0 - 2.0 * odd


@blockwise
def rotate_corner(work, change, corner, k, h):
    """Change of twice the Cayley vector of a corner that rotates about axis k. Writes: change."""
    x = 1.0 if k == 0 else 0.0
    y = 1.0 if k == 1 else 0.0
    z = 1.0 if k == 2 else 0.0
    for e in range(LANES):
        w = three(work, LANES * (WORK.spin + 3 * corner) + e)
        a, b, c = 0.5 * h * w[0], 0.5 * h * w[1], 0.5 * h * w[2]
        along, at = a * x + b * y + c * z, LANES * CHANGE.direction + e
        change[at] = x + y * c - z * b + along * a
        change[at + LANES] = y + z * a - x * c + along * b
        change[at + 2 * LANES] = z + x * b - y * a + along * c


@blockwise
def add_damping(base, entry, work, h, p):
    """Tangent of the resultants that damp the rates of strain. Writes: base."""
    plane = p.damping * p.young / (1.0 - p.poisson * p.poisson) / h
    shear, nu = 0.5 * (1.0 - p.poisson), p.poisson
    for e in range(LANES):
        t, at = work[LANES * WORK.depth + e], entry + e
        for part in range(2):
            k = plane * t if part == 0 else plane * t * t * t / 12.0
            row = at + LANES * (SIDE + 1) * BENDING * part
            base[row] += k
            base[row + LANES] += nu * k
            base[row + LANES * SIDE] += nu * k
            base[row + LANES * (SIDE + 1)] += k
            base[row + LANES * (2 * SIDE + 2)] += shear * k


@blockwise
def respond(base, entry, change):
    """Multiply the changes at a point of the plane by its tangent. Writes: change."""
    for row in range(SIDE):
        at = LANES * (CHANGE.point_stress + row)
        for e in range(LANES):
            change[at + e] = 0.0
        for k in range(SIDE):
            P = entry + LANES * (SIDE * row + k)
            for e in range(LANES):
                change[at + e] += base[P + e] * change[LANES * (CHANGE.point_strain + k) + e]


@blockwise
def set_strain_changes(change):
    """Set the changes of strains and curvatures at a point; the others are 0. Writes: change."""
    for row in range(LANES * SIDE):
        change[LANES * CHANGE.point_strain + row] = 0.0
    for row in range(6 * LANES):
        change[LANES * CHANGE.point_strain + row] = change[LANES * CHANGE.strain + row]


@kernel
def add_column(scene, matrix, change, corner, live, b, k, count):
    """A column of the elements of a block, for motion k of their corner b, into the matrix.

    `count` is that of their corners. Writes: matrix.blocks, change.
    """
    has_arms = scene.counts[0].arms > 0
    if has_arms:
        add_moments(scene, change, corner, live, count)
    for e in range(live):
        at, lane = corner + LANES * b + e, (corner, e)
        if scene.points[scene.corners[at]].fixed >> k & 1:
            continue
        put_column(scene, matrix, change, lane, b, k, 1.0, count)
        if has_arms and k < 3:
            # a rotation about axis j moves the end of an arm along axis k
            d = three_of(scene.arms, scene.corners[at])
            i, j = (k + 1) % 3, (k + 2) % 3
            put_column(scene, matrix, change, lane, b, 3 + i, d[j], count)
            put_column(scene, matrix, change, lane, b, 3 + j, -d[i], count)


@inlined
def three_of(arms, point):
    return arms[3 * point], arms[3 * point + 1], arms[3 * point + 2]


@kernel
def put_column(scene, matrix, change, lane, b, k, share, count):
    """Share of a column of one element in that of motion k of the body. Writes: matrix.blocks.

    `lane`: where the corners of its block begin, and which of the block it is.
    """
    corner, e = lane
    for a in range(count):
        address = scene.block_addresses[4 * corner + LANES * (4 * a + b) + e]
        if address < 0:
            continue
        fixed = scene.points[scene.corners[corner + LANES * a + e]].fixed
        block, at = matrix.blocks[address // 2], LANES * (CHANGE.mode_actions + 3 * a) + e
        for i in range(6):
            if fixed >> i & 1:
                continue
            # the force on the corner is the negative of that on its motion
            more = -share * change[at + LANES * (i if i < 3 else i + 9)]
            if address % 2 == 0:
                block.stiff[6 * i + k] += more
            else:
                block.stiff_above[6 * k + i] += more


@kernel
def add_moments(scene, change, corner, live, count):
    """Moments about their bodies of the forces on corners, beside the torques. Writes: change."""
    for e in range(live):
        for a in range(count):
            d = three_of(scene.arms, scene.corners[corner + LANES * a + e])
            at = LANES * (CHANGE.mode_actions + 3 * a) + e
            moment = cross3(d, three(change, at))
            for k in range(3):
                change[at + LANES * (12 + k)] += moment[k]


@kernel
def rotation_arms(scene, matrix, change, corner, live, count):
    """Add the geometric stiffness of the arms of corners. Writes: matrix.blocks."""
    for e in range(live):
        for a in range(count):
            d = three_of(scene.arms, scene.corners[corner + LANES * a + e])
            address = scene.block_addresses[4 * corner + LANES * 5 * a + e]
            if address < 0:
                continue
            f, block = (
                three(change, LANES * (CHANGE.mode_actions + 3 * a) + e),
                matrix.blocks[address // 2],
            )
            along = dot3(d, f)
            for i in range(3):
                for k in range(3):
                    # (e_k x d) x f = (e_k . f) d - (d . f) e_k
                    more = f[k] * d[i] - (along if i == k else 0.0)
                    block.stiff[6 * (3 + i) + 3 + k] -= more
