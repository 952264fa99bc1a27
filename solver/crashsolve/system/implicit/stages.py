"""Stages of a Runge-Kutta step: rates of every body, and the positions they lead to.

    r_dot = v,   m v_dot = f + D^T lambda,   L_dot = tau + D^T lambda (moments),   world components
    q = q_start * (1, g) / |(1, g)|,   g_dot = (Omega + g x Omega + g (g . Omega)) / 2

g is the Cayley vector of the rotation since the start of the step (tangent of half the angle), so
every order of the method holds for rotations and the quaternion stays of unit length. Row 0 of the
table, the ground's, holds external force and torque, and the power of prescribed motions.

Reference: Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, IV.8.
"""

from math import sqrt

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.rotation import rotate_by_cayley, write_matrix
from crashsolve.foundation.sparse.saddle import solve_rows
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.system.constraints import clear_joint_forces, driver_power

EPSILON = 2.0**-52
SAFETY = 0.8  # of the step at which the error is the tolerance
LEAST_SPEED = 1e-50  # [m/s] a slower body counts as at rest: squares of less underflow


@kernel
def store_rates(nodes, rows, stages, i):
    """The rates of all bodies at stage i. Writes: stages."""
    for n in range(1, nodes.shape[0]):
        b, s = nodes[n], stages[i, n]
        put(s.rate_r, vec(b.v))
        put(s.rate_rotation, rotation_rate_of(matvec_t(b.A, vec(b.w)), vec(s.rotation)))
        put(s.rate_v, scale(b.mass_inv, add(vec(b.force), vec(b.joint_force))))
        put(s.rate_L, add(vec(b.torque), vec(b.joint_torque)))
    store_external(nodes, rows, stages, i)


@kernel
def rotation_rate_of(omega, g):
    """g_dot of a spin in body axes."""
    return scale(0.5, add_scaled(add(omega, cross(g, omega)), dot(g, omega), g))


@kernel
def rotation_of_change(g_change, g):
    """The rotation in body axes that changes the Cayley vector g by a given amount."""
    return scale(2.0 / (1.0 + dot(g, g)), sub(g_change, cross(g, g_change)))


@kernel
def store_external(nodes, rows, stages, i):
    """External force, torque and power at stage i. Writes: stages."""
    ground, external_row = nodes[0], stages[i, 0]
    for k in range(3):
        external_row.rate_v[k] = ground.external[k] - ground.force[k] - ground.joint_force[k]
        external_row.rate_L[k] = ground.external[3 + k] - ground.torque[k] - ground.joint_torque[k]
    external_row.rate_r[0] = driver_power(rows)


@kernel
def advance_to_stage(nodes, stages, A, i, h):
    """Move all bodies from the start of the step to stage i. Writes: nodes, stages."""
    first = stages.shape[0] * i
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        r, v, L = vec(b.start_r), vec(b.start_v), vec(b.start_L)
        g = (0.0, 0.0, 0.0)
        for j in range(i):
            a, s = h * A[first + j], stages[j, n]
            # as is half of a tableau of high order
            if a == 0.0:
                continue
            r = add_scaled(r, a, vec(s.rate_r))
            g = add_scaled(g, a, vec(s.rate_rotation))
            v = add_scaled(v, a, vec(s.rate_v))
            L = add_scaled(L, a, vec(s.rate_L))
        put(stages[i, n].rotation, g)
        put(b.r, r)
        put(b.v, v)
        put(b.L, L)
        rotate_by_cayley(b.start_q, g, b.q)
        write_matrix(b.q, b.A)


@kernel
def displace_by_joints(rows, nodes):
    """Move bodies by X^T times the solution, X = D M^-1. Writes: nodes.r, q, A, joint_*."""
    clear_joint_forces(nodes)
    for k in range(rows.shape[0]):
        row = rows[k]
        a, b = nodes[row.node_a], nodes[row.node_b]
        add_column(row.X, 0, row.delta, a.joint_force, a.joint_torque)
        add_column(row.X, 6, row.delta, b.joint_force, b.joint_torque)
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        put(b.r, add(vec(b.r), vec(b.joint_force)))
        rotate_by_cayley(b.q, scale(0.5, matvec_t(b.A, vec(b.joint_torque))), b.q)
        write_matrix(b.q, b.A)


@kernel
def fastest_point(nodes, size):
    """Largest speed of any body [m/s]; a rotation counts at the model's size."""
    fastest = 0.0
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        fastest = max(fastest, norm(vec(b.v)), size * norm(vec(b.w)))
    return fastest


@kernel
def fastest_so_far(clock, control, nodes):
    """Largest speed of any body so far [m/s]; once anything moves, at least that of prescribed
    motions.
    """
    fastest = fastest_point(nodes, control.length)
    least = control.least_speed if fastest > LEAST_SPEED else 0.0
    return max(clock.fastest, fastest, least)


@kernel
def spin_round_off(nodes):
    """Round-off of the spin W L of any body [rad/s]: much for a slender one."""
    largest = 0.0
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        largest = max(largest, (b.W[0] + b.W[4] + b.W[8]) * norm(vec(b.L)))
    return EPSILON * largest


@kernel
def reference_speed(clock):
    """Speed to which the error of a step is compared [m/s]: 1 m/s as long as nothing moves."""
    return clock.fastest if clock.fastest > LEAST_SPEED else 1.0


@kernel
def typical_speed(nodes, size):
    """Largest speed of any body, or that which it would reach over the model's size [m/s]."""
    fastest = fastest_point(nodes, size)
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        acceleration = max(norm(vec(b.v_dot)), size * norm(vec(b.w_dot)))
        fastest = max(fastest, sqrt(size * acceleration))
    return fastest


@kernel
def estimate(nodes, stages, count, E, errors, k, h):
    """Estimate k of the error in position, rotation, velocity and spin. Writes: errors."""
    zero = (0.0, 0.0, 0.0)
    for n in range(1, nodes.shape[0]):
        b, e = nodes[n], errors[k, n]
        r, g, v, L = zero, zero, zero, zero
        for j in range(count):
            s, a = stages[j, n], h * E[count * k + j]
            r = add_scaled(r, a, vec(s.rate_r))
            g = add_scaled(g, a, vec(s.rate_rotation))
            v = add_scaled(v, a, vec(s.rate_v))
            L = add_scaled(L, a, vec(s.rate_L))
        put(e.r, r)
        put(e.v, v)
        put(e.w, matvec(b.W, L))
        # of the rotation, from that of its Cayley vector
        rotation = vec(stages[count - 1, n].rotation)
        share = 2.0 / (1.0 + dot(rotation, rotation))
        put(e.rotation, scale(share, matvec(b.A, sub(g, cross(rotation, g)))))


@kernel
def project_estimate(errors, k, nodes, rows, saddle):
    """Project an estimate as the step is projected: D e = 0. Writes: errors, rows."""
    project_pair(errors, k, rows, saddle, True)
    project_pair(errors, k, rows, saddle, False)


@kernel
def project_pair(errors, k, rows, saddle, of_positions):
    """Project the estimate of positions and rotations, or of velocities and spins:

    D e = 0. Writes: errors, rows.
    """
    for i in range(rows.shape[0]):
        row = rows[i]
        x_a, y_a = pair_of(errors[k, row.node_a], of_positions)
        x_b, y_b = pair_of(errors[k, row.node_b], of_positions)
        row.right = along_row(row.D, 0, x_a, y_a) + along_row(row.D, 6, x_b, y_b)
    solve_rows(saddle, rows, -1.0)
    for i in range(rows.shape[0]):
        row = rows[i]
        x_a, y_a = pair_of(errors[k, row.node_a], of_positions)
        x_b, y_b = pair_of(errors[k, row.node_b], of_positions)
        add_column(row.X, 0, row.delta, x_a, y_a)
        add_column(row.X, 6, row.delta, x_b, y_b)


@inlined
def pair_of(e, of_positions):
    """Errors of a body in position and rotation, or in velocity and spin."""
    return (e.r, e.rotation) if of_positions else (e.v, e.w)


@kernel
def along_row(D, c, x, y):
    """Columns c to c + 5 of a row times the vectors x and y."""
    return dot((D[c], D[c + 1], D[c + 2]), vec(x)) + dot((D[c + 3], D[c + 4], D[c + 5]), vec(y))


@kernel
def add_column(X, c, factor, x, y):
    """Add columns c to c + 5 of a row, times a factor. Writes: x, y."""
    add_to(x, scale(factor, (X[c], X[c + 1], X[c + 2])))
    add_to(y, scale(factor, (X[c + 3], X[c + 4], X[c + 5])))


@kernel
def step_error(errors, size, speed):
    """Estimated error of the step, over the model's size and its largest speed.

    Hairer, Norsett and Wanner (1993), II.10: a second estimate, of lower order, guards the first.
    """
    worst = 0.0
    for n in range(1, errors.shape[1]):
        x = deviation(errors[0, n], size, speed)
        if errors.shape[0] > 1 and x != 0.0:
            share = deviation(errors[1, n], size, speed) / x
            x /= sqrt(1.0 + 0.01 * share * share)
        # a NaN must win the comparison
        if not x <= worst:
            worst = x
    return worst


@kernel
def deviation(e, size, speed):
    """Estimated errors of one body in units of size and speed."""
    return (
        norm(vec(e.r)) / size
        + norm(vec(e.rotation))
        + (norm(vec(e.v)) + size * norm(vec(e.w))) / speed
    )


@kernel
def add_external(clock, stages, A, i, h):
    """External impulses and the work of prescribed motions up to stage i. Writes: clock."""
    first = stages.shape[0] * i
    for j in range(stages.shape[0]):
        a, external_row = h * A[first + j], stages[j, 0]
        # what a rejected step left in a stage that this sum does not have may be no number
        if a == 0.0:
            continue
        add_to(clock.impulse, scale(a, vec(external_row.rate_v)))
        add_to(clock.angular_impulse, scale(a, vec(external_row.rate_L)))
        clock.driver_work += a * external_row.rate_r[0]


@kernel
def record_kick(clock, nodes):
    """Add the impulse of the ground in the projection of velocities. Writes: clock.kick."""
    ground = nodes[0]
    for k in range(3):
        clock.kick[k] -= ground.joint_force[k]
        clock.kick[3 + k] -= ground.joint_torque[k]


@kernel
def add_kick(clock, sign):
    """Add that to the external impulses, or subtract it (-1). Writes: clock."""
    for k in range(3):
        clock.impulse[k] += sign * clock.kick[k]
        clock.angular_impulse[k] += sign * clock.kick[3 + k]


@kernel
def set_dense_weights(A, D, terms, last, sample, part):
    """Weights of all rates in the dense output at a part of the step, as those of a further stage.

    Hairer, Norsett and Wanner (1993), II.6. The cubic through both ends of the step comes first,
    then the terms D, by turns a power of part and of 1 - part higher. Writes: A, last row.
    """
    remainder = 1.0 - part
    for j in range(sample):
        a = A[(sample + 1) * last + j]
        first = 1.0 if j == 0 else 0.0
        end = 1.0 if j == last else 0.0
        weight = part * (a + remainder * (first - a + part * (2.0 * a - first - end)))
        power = part * part * remainder * remainder
        for k in range(terms):
            weight += power * D[sample * k + j]
            power *= part if k % 2 == 0 else remainder
        A[(sample + 1) * sample + j] = weight


@kernel
def next_length(h, error, clock, tolerance, order):
    """Length of the next step, or of another attempt, from the error of this one [s].

    Errors of neighbouring steps scatter, most where the order is high; a filter follows their
    trend, so that few attempts fail. Soderlind (2003), ACM Trans. Math. Softw. 29, 1-26 (H211b).
    """
    if error <= 0.0:
        return 5.0 * h
    if not error < 1e300:
        return 0.1 * h
    share = SAFETY * (tolerance / error) ** (1.0 / order)
    # a step that was cut short shows no trend
    if error <= tolerance and clock.error > 0.0 and 0.2 * h < clock.step < 5.0 * h:
        before = SAFETY * (tolerance / clock.error) ** (1.0 / order)
        share = (share * before * clock.step / h) ** 0.25
    return h * min(5.0, max(0.2, share))
