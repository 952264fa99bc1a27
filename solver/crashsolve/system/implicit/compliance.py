"""Linear equations of an implicit stage: springs as compliant constraint rows.

    dv = b + M^-1 D^T m,   dq = a + t dv,   D dv = D b for a joint, for a spring
    m = -t (k D dq + c (D dv + G dq)),   G = derivative of D v by the position

With B = D + c t G / (c + k t) in place of D, and sigma = t (c + k t), these are

    (B M^-1 B^T + 1 / sigma) m = -B b - (k D + c G) a / (c + k t)

A joint is a spring with 1 / sigma = 0. Springs of any stiffness are thus solved with the joints in
one symmetric positive definite matrix, of the size of the rows and not of the bodies, by the
factorisation that joints have already. B^T for D^T on the side of the force, how a force turns with
the bodies and the gyroscopic torque are left to the iteration: they shrink with the step, however
stiff the spring.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
"""

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.sparse.saddle import assemble, eliminate, solve_rows
from crashsolve.foundation.vec3 import norm, put, scale, vec
from crashsolve.system.constraints import apply_inverse_mass
from crashsolve.system.implicit.stages import (
    add_column,
    along_row,
    rotation_of_change,
    rotation_rate_of,
)

# 1 / sigma of a row without stiffness, or with a negative one, which has no effect
NO_PART = 1e150


@kernel
def linearise(rows, compliant, nodes, velocity, position):
    """D of the joints, and B and B M^-1 of the springs, at the present position. Writes:
    compliant.
    """
    joint_rows = rows.shape[0]
    for k in range(compliant.shape[0]):
        row = compliant[k]
        a, b = nodes[row.node_a], nodes[row.node_b]
        if k < joint_rows:
            for j in range(12):
                row.D[j] = rows[k].D[j]
        else:
            combine_tangents(row, velocity, position)
        apply_inverse_mass(row.D, row.X, 0, a)
        apply_inverse_mass(row.D, row.X, 6, b)


@kernel
def combine_tangents(row, velocity, position):
    """D becomes B, and G becomes (k D + c G) / (c + k t), t = position / velocity. Writes: row."""
    D, G, k, c = row.D, row.G, row.stiffness, row.damping
    sigma_over_t = velocity * c + position * k
    for j in range(12):
        d, g = D[j], G[j]
        D[j] = d + c * position / sigma_over_t * g if sigma_over_t > 0.0 else d
        G[j] = velocity * (k * d + c * g) / sigma_over_t if sigma_over_t > 0.0 else 0.0


@kernel
def factor_compliant(saddle, compliant, joint_rows, position, velocity):
    """Factor of D M^-1 D^T + 1 / sigma, sigma = position k + velocity c. Writes: saddle."""
    assemble(saddle, compliant)
    columns, blocks = saddle.columns, saddle.blocks
    for p in range(columns.shape[0]):
        c = columns[p]
        if c.entry >= joint_rows:
            for i in range(c.rows):
                at = c.first + (c.rows + 1) * i
                blocks[at] += compliance_of(compliant[c.entry + i], position, velocity)
    eliminate(saddle)


@kernel
def compliance_of(row, position, velocity):
    """1 / sigma of a row [1/kg]."""
    sigma = position * row.stiffness + velocity * row.damping
    return 1.0 / sigma if sigma > 1.0 / NO_PART else NO_PART


@kernel
def solve_stage(nodes, stages, i, compliant, saddle, joint_rows, t):
    """Correction of stage i, in place of its residual. Writes: stages.right_*, slope_*."""
    for k in range(joint_rows, compliant.shape[0]):
        row = compliant[k]
        row.right = -residual_along(row, 0, row.node_a, nodes, stages, i)
        row.right -= residual_along(row, 6, row.node_b, nodes, stages, i)
    solve_rows(saddle, compliant, 1.0)
    sum_row_impulses(stages, i, compliant)
    for n in range(1, nodes.shape[0]):
        b, s = nodes[n], stages[i, n]
        add_to(s.right_v, vec(s.slope_v))
        add_to(s.right_w, vec(s.slope_w))
        put(s.slope_v, scale(1.0 / t, vec(s.slope_v)))
        put(s.slope_w, scale(1.0 / t, vec(s.slope_w)))
        put(s.slope_r, vec(s.right_v))
        put(s.slope_rotation, rotation_rate_of(matvec_t(b.A, vec(s.right_w)), vec(s.rotation)))
        add_to(s.right_r, scale(t, vec(s.slope_r)))
        add_to(s.right_rotation, scale(t, vec(s.slope_rotation)))


@kernel
def sum_row_impulses(stages, i, compliant):
    """Sum the impulses of all rows on each body. Writes: stages.slope_v, slope_w."""
    zero = (0.0, 0.0, 0.0)
    for n in range(stages.shape[1]):
        put(stages[i, n].slope_v, zero)
        put(stages[i, n].slope_w, zero)
    for k in range(compliant.shape[0]):
        row = compliant[k]
        a, b = stages[i, row.node_a], stages[i, row.node_b]
        add_column(row.X, 0, row.delta, a.slope_v, a.slope_w)
        add_column(row.X, 6, row.delta, b.slope_v, b.slope_w)


@kernel
def residual_along(row, c, node, nodes, stages, i):
    """One body's part of B b + (k D + c G) a / (c + k t) of a row, for the residual of stage i."""
    if node == 0:
        return 0.0
    s = stages[i, node]
    rotation = matvec(nodes[node].A, rotation_of_change(vec(s.right_rotation), vec(s.rotation)))
    return along_row(row.D, c, s.right_v, s.right_w) + along_row(row.G, c, s.right_r, rotation)


@kernel
def set_rate_right_sides(rows, compliant, stages, t):
    """Right sides for D v - nu over t, and for residuals of accelerations. Writes: compliant."""
    for k in range(compliant.shape[0]):
        row = compliant[k]
        # the ground has no residual
        a, b = stages[1, row.node_a], stages[1, row.node_b]
        row.right = -along_row(row.D, 0, a.right_v, a.right_w)
        row.right -= along_row(row.D, 6, b.right_v, b.right_w)
        if k < rows.shape[0]:
            row.right -= rows[k].right / t


@kernel
def solve_corrections(nodes, rows, stages, compliant, saddle):
    """Corrections of multipliers and accelerations. Writes: rows.trial, stages.right_*, slope_*."""
    solve_rows(saddle, compliant, 1.0)
    sum_row_impulses(stages, 1, compliant)
    for k in range(rows.shape[0]):
        rows[k].trial += compliant[k].delta
    for n in range(1, nodes.shape[0]):
        end = stages[1, n]
        add_to(end.right_v, vec(end.slope_v))
        add_to(end.right_w, vec(end.slope_w))


@kernel
def correct_closure(stages, compliant, saddle, size):
    """Displacements onto Phi = 0. Returns the largest, in the model's size. Writes: stages."""
    solve_rows(saddle, compliant, 1.0)
    sum_row_impulses(stages, 1, compliant)
    worst = 0.0
    for n in range(1, stages.shape[1]):
        end = stages[1, n]
        add_to(end.closing_r, vec(end.slope_v))
        add_to(end.closing_w, vec(end.slope_w))
        x = norm(vec(end.slope_v)) / size + norm(vec(end.slope_w))
        if not x <= worst:
            worst = x
    return worst
