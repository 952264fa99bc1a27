"""Constraint stages of the step: D M^-1, D^T lambda, and the two projections.

    position   Phi(q(lambda)) = 0      simplified Newton with S = D M^-1 D^T of the step's start
    velocity   D v = nu                one solve with S of the step's end

Sign: D^T lambda is the force of the constraint on the bodies (Ambrosio (2003), Eq. 4; the chapter's
Eq. 5 prints the opposite sign of lambda).
"""

from crashsolve.foundation.columns import add_to, matvec
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.sparse.saddle import factorise
from crashsolve.foundation.vec3 import ZERO, add_scaled, dot, put, vec
from crashsolve.system.kinetics import accelerations, drift_body, kicked


@kernel
def factor_constraints(rows, saddle, nodes):
    """Ambrosio (2003), Eq. 5: X = D M^-1, and the factor of S = D X^T. Writes: rows.X, saddle."""
    for k in range(rows.shape[0]):
        row = rows[k]
        apply_inverse_mass(row.D, row.X, 0, nodes[row.node_a])
        apply_inverse_mass(row.D, row.X, 6, nodes[row.node_b])
    factorise(saddle, rows, nodes)


@kernel
def apply_inverse_mass(D, X, c, body):
    """Columns c to c + 5 of D M^-1. Writes: X."""
    X[c] = body.mass_inv * D[c]
    X[c + 1] = body.mass_inv * D[c + 1]
    X[c + 2] = body.mass_inv * D[c + 2]
    x = matvec(body.W, (D[c + 3], D[c + 4], D[c + 5]))
    X[c + 3] = x[0]
    X[c + 4] = x[1]
    X[c + 5] = x[2]


@kernel
def clear_joint_forces(nodes):
    """Writes: nodes.joint_force, joint_torque."""
    for i in range(nodes.shape[0]):
        put(nodes[i].joint_force, (0.0, 0.0, 0.0))
        put(nodes[i].joint_torque, (0.0, 0.0, 0.0))


@kernel
def scatter(rows, nodes):
    """Add D^T delta of all rows to their nodes. Writes: nodes.joint_*."""
    k, count = 0, rows.shape[0]
    while k < count:
        node_a, node_b = rows[k].node_a, rows[k].node_b
        # rows of a joint have the same nodes, and add up before these are written
        pushes = (ZERO, ZERO, ZERO, ZERO)
        while k < count and rows[k].node_a == node_a and rows[k].node_b == node_b:
            pushes = add_row_forces(pushes, rows[k].D, rows[k].delta)
            k += 1
        a, b = nodes[node_a], nodes[node_b]
        add_to(a.joint_force, pushes[0])
        add_to(a.joint_torque, pushes[1])
        add_to(b.joint_force, pushes[2])
        add_to(b.joint_torque, pushes[3])


@inlined
def add_row_forces(pushes, D, multiplier):
    """Force and torque on a, and on b, with those of one more row."""
    return (
        add_scaled(pushes[0], multiplier, (D[0], D[1], D[2])),
        add_scaled(pushes[1], multiplier, (D[3], D[4], D[5])),
        add_scaled(pushes[2], multiplier, (D[6], D[7], D[8])),
        add_scaled(pushes[3], multiplier, (D[9], D[10], D[11])),
    )


@kernel
def scatter_trial(rows, nodes):
    """Constraint forces of the drift being tried. Writes: rows.delta, nodes.joint_*."""
    clear_joint_forces(nodes)
    for k in range(rows.shape[0]):
        rows[k].delta = rows[k].trial
    scatter(rows, nodes)


@kernel
def correct_trial(rows, nodes):
    """Add a correction to the lambda being tried and to its forces. Writes: rows.trial, nodes."""
    for k in range(rows.shape[0]):
        rows[k].trial += rows[k].delta
    scatter(rows, nodes)


@kernel
def scatter_delta(rows, nodes):
    """Add a correction to the lambda of a kick and to its forces. Writes: rows.reaction, nodes."""
    for k in range(rows.shape[0]):
        rows[k].reaction += rows[k].delta
    scatter(rows, nodes)


@kernel
def kick_half_by_joints(nodes, factor):
    """Add factor * joint force to the momenta of the drift. Writes: nodes.v_half, L_half."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        put(b.v_half, add_scaled(vec(b.v_half), factor * b.mass_inv, vec(b.joint_force)))
        put(b.L_half, add_scaled(vec(b.L_half), factor, vec(b.joint_torque)))


@kernel
def kick_with_joints_and_drift(nodes, h, again):
    """First half kick by all forces, and drift; again: of bodies whose momenta differ from before.

    Writes: nodes.v_half, L_half, r, q, A.
    """
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if b.is_attached == 1:
            # until the force pass moves it with its body
            put(b.r, add_scaled(vec(b.start_r), h, vec(b.start_v)))
            continue
        v, L = kicked(b, h, vec(b.start_v), vec(b.start_L))
        v = add_scaled(v, 0.5 * h * b.mass_inv, vec(b.joint_force))
        L = add_scaled(L, 0.5 * h, vec(b.joint_torque))
        # most bodies are in no joint, and stay where they were
        if not again or differ(v, b.v_half) or differ(L, b.L_half):
            put(b.v_half, v)
            put(b.L_half, L)
            drift_body(b, h)


@inlined
def differ(x, column):
    """Whether a vector is another than that of a column."""
    return not (x[0] == column[0] and x[1] == column[1] and x[2] == column[2])


@kernel
def kick_by_joints(nodes, factor):
    """Add factor * joint force to the momenta. Writes: nodes.v, L, w."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if any_of(b.joint_force) or any_of(b.joint_torque):
            put(b.v, add_scaled(vec(b.v), factor * b.mass_inv, vec(b.joint_force)))
            put(b.L, add_scaled(vec(b.L), factor, vec(b.joint_torque)))
            put(b.w, matvec(b.W, vec(b.L)))


@inlined
def any_of(column):
    """Whether a vector is not zero."""
    return column[0] != 0.0 or column[1] != 0.0 or column[2] != 0.0


@kernel
def velocity_residual(rows, nodes):
    """D v - nu of every row. Writes: rows.right."""
    for k in range(rows.shape[0]):
        row = rows[k]
        a, b = nodes[row.node_a], nodes[row.node_b]
        row.right = along_row(row.D, (a.v, a.w, b.v, b.w)) - row.nu


@inlined
def along_row(D, motion):
    """A row of D times the vectors of its two bodies: of a, turning of a, of b, turning of b."""
    v_a, w_a, v_b, w_b = motion
    x = dot((D[0], D[1], D[2]), vec(v_a)) + dot((D[3], D[4], D[5]), vec(w_a))
    return x + (dot((D[6], D[7], D[8]), vec(v_b)) + dot((D[9], D[10], D[11]), vec(w_b)))


@kernel
def acceleration_right_side(rows, nodes):
    """gamma - D v_dot of every row, lambda as it stands. Writes: nodes.v_dot, w_dot, rows.right."""
    accelerations(nodes)
    for k in range(rows.shape[0]):
        row = rows[k]
        a, b = nodes[row.node_a], nodes[row.node_b]
        row.right = row.gamma - along_row(row.D, (a.v_dot, a.w_dot, b.v_dot, b.w_dot))


@kernel
def worst_residual(rows):
    """Largest |Phi| in units of the model's size, and its row. Writes: rows.right."""
    worst, at = 0.0, 0
    for k in range(rows.shape[0]):
        rows[k].right = rows[k].phi
        x = abs(rows[k].phi) / rows[k].scale
        # a NaN must win the comparison
        if not x <= worst:
            worst, at = x, k
    return worst, at


@kernel
def extrapolate_trial(rows, ratio):
    """First guess of lambda, `ratio` the new step over the last. Writes: rows.trial.

    A drift closes positions at its end, so that its lambda differs from that of the kick at its
    start by a term in proportion to the step, and by the residual of the drift before. The kick
    has neither; the line through the last two drifts would have twice of the latter.
    """
    for k in range(rows.shape[0]):
        row = rows[k]
        row.trial = row.reaction + ratio * (row.multiplier - row.before)


@kernel
def keep_trial(rows):
    """The drift is accepted: keep its lambda. Writes: rows.multiplier, before.

    Returns the power of prescribed motions at the start of the step [W].
    """
    power = 0.0
    for k in range(rows.shape[0]):
        row = rows[k]
        row.before = row.reaction
        row.multiplier = row.trial
        power += row.trial * row.nu
    return power


@kernel
def driver_power(rows):
    """Power of prescribed motions, lambda . nu [W]: bodies gain D v . lambda."""
    total = 0.0
    for k in range(rows.shape[0]):
        total += rows[k].reaction * rows[k].nu
    return total


@kernel
def clear_reaction(rows, nodes):
    """Writes: rows.reaction, nodes.joint_*."""
    clear_joint_forces(nodes)
    for k in range(rows.shape[0]):
        rows[k].reaction = 0.0


@kernel
def worst_rate(rows, saddle):
    """Largest |D v - nu| in units of the model's size per second.

    The parts of a row add up, so it is judged joint by joint.
    """
    worst = 0.0
    columns = saddle.columns
    for p in range(columns.shape[0]):
        c = columns[p]
        # a hub has no rows
        for i in range(c.rows if c.end > c.entry else 0):
            k = c.entry + i
            total = 0.0
            while k < c.end:
                total += rows[k].right
                k += c.rows
            x = abs(total) / rows[c.entry + i].scale
            if not x <= worst:
                worst = x
    return worst


@kernel
def clear_trial(rows, nodes):
    """Writes: rows.trial, nodes.joint_*."""
    clear_joint_forces(nodes)
    for k in range(rows.shape[0]):
        rows[k].trial = 0.0
