"""Linear equations of an implicit stage with elements: all bodies at once, joints beside them.

    (M + t C + t^2 K) dv - D^T m = M b - t K a - C_G a,   D dv = D b

with the residuals a and b of positions and velocities (compliance.py). In compliance.py every
spring is a row of the matrix; an element of a shell has thirteen rows, and shares each of its nodes
with three others, so that here nodes are the unknowns: 6 of them where there are 13 rows. Rows hold
no more of a tangent than D^T k D; blocks also hold its part by the rotation of forces. K
of the elements stands in the blocks of the matrix (stiffness.py, elements/beams/tangent.py), that
of springs and contacts comes from their compliant rows, and so does damping. Consequence to test:
the same corrections as by rows.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
"""

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.rotation import write_world_tensor
from crashsolve.foundation.sparse.bordered import assemble, factorise, solve
from crashsolve.foundation.vec3 import norm, put, scale, sub, vec
from crashsolve.system.implicit.compliance import combine_tangents
from crashsolve.system.implicit.stages import along_row, rotation_of_change, rotation_rate_of


@kernel
def clear_matrix(nodes, matrix):
    """Masses of the nodes, and no stiffness yet. Writes: matrix."""
    set_masses(nodes, matrix.columns)
    for e in range(matrix.blocks.shape[0]):
        for k in range(36):
            matrix.blocks[e].stiff[k] = matrix.blocks[e].stiff_above[k] = 0.0


@kernel
def set_masses(nodes, columns):
    """Masses and inertias of the nodes at their present configuration. Writes: columns."""
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            b = nodes[c.node]
            c.mass = 1.0 / b.mass_inv
            write_world_tensor(b.A, b.J, c.J)


@kernel
def linearise(rows, compliant, nodes, velocity, position):
    """D of the joints, and B of the springs, at the present position. Writes: compliant."""
    for k in range(compliant.shape[0]):
        row = compliant[k]
        if k < rows.shape[0]:
            for j in range(12):
                row.D[j] = rows[k].D[j]
        else:
            combine_tangents(row, velocity, position)


@kernel
def factor_compliant(matrix, compliant, joint_rows, position, velocity):
    """Factor of the global matrix. Writes: matrix, compliant.X."""
    assemble(matrix, compliant, joint_rows, position, velocity)
    factorise(matrix)


@kernel
def set_rate_right_sides(rows, compliant, stages, t):
    """Right sides for D v - nu over t. Writes: compliant."""
    for k in range(rows.shape[0]):
        compliant[k].right = -rows[k].right / t


@kernel
def solve_corrections(nodes, rows, stages, compliant, matrix):
    """Corrections of multipliers and accelerations. Writes: rows.trial, stages.right_*."""
    for p in range(matrix.columns.shape[0]):
        c = matrix.columns[p]
        if c.node > 0:
            end = stages[1, c.node]
            set_right_side(c, scale(c.mass, vec(end.right_v)), matvec(c.J, vec(end.right_w)))
    solve_with(matrix, compliant, rows.shape[0])
    for k in range(rows.shape[0]):
        rows[k].trial += compliant[k].delta
    for p in range(matrix.columns.shape[0]):
        c = matrix.columns[p]
        if c.node > 0:
            v, w = solution_of(c)
            put(stages[1, c.node].right_v, v)
            put(stages[1, c.node].right_w, w)


@kernel
def set_right_side(c, f, torque):
    """Right side of a node. Writes: c.work."""
    for k in range(3):
        c.work[k], c.work[3 + k] = f[k], torque[k]


@kernel
def solution_of(c):
    """Solution of a node: of its position and of its configuration."""
    return (c.work[0], c.work[1], c.work[2]), (c.work[3], c.work[4], c.work[5])


@kernel
def solve_with(matrix, compliant, joint_rows):
    """Solution for the joints, with the right sides in their rows. Writes: compliant.delta."""
    for p in range(matrix.columns.shape[0]):
        c = matrix.columns[p]
        if c.node == 0:
            for i in range(c.rows):
                c.work[i] = 0.0
                # the parts of a row add up
                for k in range(c.entry + i, c.end, c.rows):
                    c.work[i] += compliant[k].right
    solve(matrix)
    for p in range(matrix.columns.shape[0]):
        c = matrix.columns[p]
        if c.node == 0:
            for i in range(c.rows):
                for k in range(c.entry + i, c.end, c.rows):
                    compliant[k].delta = -c.work[i]


@kernel
def correct_closure(stages, compliant, matrix, size):
    """Displacements onto Phi = 0. Returns the largest, in the model's size. Writes: stages."""
    columns, zero, worst = matrix.columns, (0.0, 0.0, 0.0), 0.0
    for p in range(columns.shape[0]):
        if columns[p].node > 0:
            set_right_side(columns[p], zero, zero)
    solve_with(matrix, compliant, 0)
    for p in range(columns.shape[0]):
        if columns[p].node > 0:
            r, w = solution_of(columns[p])
            end = stages[1, columns[p].node]
            add_to(end.closing_r, r)
            add_to(end.closing_w, w)
            x = norm(r) / size + norm(w)
            if not x <= worst:
                worst = x
    return worst


@kernel
def solve_stage(nodes, stages, i, compliant, matrix, joint_rows, t):
    """Correction of stage i, in place of its residual. Writes: stages.right_*, slope_*."""
    columns = matrix.columns
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            s = stages[i, c.node]
            set_right_side(c, scale(c.mass, vec(s.right_v)), matvec(c.J, vec(s.right_w)))
    subtract_element_stiffness(nodes, stages, i, matrix, t)
    for k in range(joint_rows):
        row = compliant[k]
        a, b = stages[i, row.node_a], stages[i, row.node_b]
        row.right = along_row(row.D, 0, a.right_v, a.right_w)
        row.right += along_row(row.D, 6, b.right_v, b.right_w)
    for k in range(joint_rows, compliant.shape[0]):
        subtract_spring_stiffness(nodes, stages, i, compliant[k], matrix.slots[k], matrix)
    solve_with(matrix, compliant, joint_rows)
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            correct(nodes[c.node], stages[i, c.node], c, t)


@kernel
def subtract_element_stiffness(nodes, stages, i, matrix, t):
    """Subtract t K a of the elements. Writes: matrix.columns.work."""
    columns, blocks = matrix.columns, matrix.blocks
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.node > 0:
            x, rotation = displacement(nodes[c.node], stages[i, c.node])
            x = (x[0], x[1], x[2], rotation[0], rotation[1], rotation[2])
            for e in range(c.block, c.block_end):
                other = columns[blocks[e].column]
                if other.node == 0:
                    continue
                stiff = blocks[e].stiff
                for k in range(6):
                    total = 0.0
                    for j in range(6):
                        total += stiff[6 * k + j] * x[j]
                    other.work[k] -= t * total
                if e == c.block:
                    continue
                y, rotation = displacement(nodes[other.node], stages[i, other.node])
                y = (y[0], y[1], y[2], rotation[0], rotation[1], rotation[2])
                for k in range(6):
                    total = 0.0
                    for j in range(6):
                        total += blocks[e].stiff_above[6 * j + k] * y[j]
                    c.work[k] -= t * total


@kernel
def displacement(body, s):
    """Residual displacement and rotation of a body, world axes."""
    return vec(s.right_r), matvec(
        body.A, rotation_of_change(vec(s.right_rotation), vec(s.rotation))
    )


@kernel
def subtract_spring_stiffness(nodes, stages, i, row, slot, matrix):
    """Subtract X (G a) of a spring. Writes: matrix.columns.work."""
    if row.stiffness == 0.0 and row.damping == 0.0:
        return
    x = 0.0
    if row.node_a > 0:
        s = stages[i, row.node_a]
        r, rotation = displacement(nodes[row.node_a], s)
        x += along_pair(row.G, 0, r, rotation)
    if row.node_b > 0:
        s = stages[i, row.node_b]
        r, rotation = displacement(nodes[row.node_b], s)
        x += along_pair(row.G, 6, r, rotation)
    for side in range(2):
        block = slot.a if side == 0 else slot.b
        if block >= 0:
            c = matrix.columns[matrix.blocks[block].column]
            for k in range(6):
                c.work[k] -= row.X[6 * side + k] * x


@kernel
def along_pair(D, c, x, y):
    """Columns c to c + 5 of a row times two vectors."""
    total = 0.0
    for k in range(3):
        total += D[c + k] * x[k] + D[c + 3 + k] * y[k]
    return total


@kernel
def correct(b, s, c, t):
    """Corrections of one body at its stage (see collocation.py). Writes: s."""
    v, w = solution_of(c)
    put(s.slope_v, scale(1.0 / t, sub(v, vec(s.right_v))))
    put(s.slope_w, scale(1.0 / t, sub(w, vec(s.right_w))))
    put(s.right_v, v)
    put(s.right_w, w)
    put(s.slope_r, v)
    put(s.slope_rotation, rotation_rate_of(matvec_t(b.A, w), vec(s.rotation)))
    add_to(s.right_r, scale(t, v))
    add_to(s.right_rotation, scale(t, vec(s.slope_rotation)))
