"""Stages of a Runge-Kutta step: rates of every body, and the places they lead to.

    r_dot = v,   m v_dot = f + D^T lambda,   L_dot = tau + D^T lambda (moments),   world components
    q = q_start * (1, g) / |(1, g)|,   g_dot = (Omega + g x Omega + g (g . Omega)) / 2

g is the Cayley vector of the turn since the start of the step (tangent of half the angle), so every
order of the method holds for rotations and the quaternion stays of unit length. Row 0 of the table,
the ground's, keeps what comes from outside: force, torque, and the power of prescribed motions.

Reference: Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, IV.8.
"""

from math import sqrt

from crashsolve.foundation.compile import kernel
from crashsolve.foundation.rotation import rotate_by_cayley, write_matrix
from crashsolve.foundation.vec3 import (
    add,
    add_scaled,
    add_to,
    cross,
    dot,
    matvec,
    matvec_t,
    norm,
    put,
    scale,
    vec,
)
from crashsolve.system.constraints import driver_power


@kernel
def keep_rates(nodes, rows, stages, i):
    """The rates of all bodies at stage i. Writes: stages."""
    for n in range(1, nodes.shape[0]):
        b, s = nodes[n], stages[i, n]
        put(s.rate_r, vec(b.v))
        omega, g = matvec_t(b.A, vec(b.w)), vec(s.turn)
        turning = add_scaled(add(omega, cross(g, omega)), dot(g, omega), g)
        put(s.rate_turn, scale(0.5, turning))
        put(s.rate_v, scale(b.mass_inv, add(vec(b.force), vec(b.joint_force))))
        put(s.rate_L, add(vec(b.torque), vec(b.joint_torque)))
    keep_outside(nodes, rows, stages, i)


@kernel
def keep_outside(nodes, rows, stages, i):
    """Force, torque and power from outside at stage i. Writes: stages."""
    ground, outside = nodes[0], stages[i, 0]
    for k in range(3):
        outside.rate_v[k] = ground.external[k] - ground.force[k] - ground.joint_force[k]
        outside.rate_L[k] = ground.external[3 + k] - ground.torque[k] - ground.joint_torque[k]
    outside.rate_r[0] = driver_power(rows)


@kernel
def reach(nodes, stages, A, i, h):
    """Move all bodies from the start of the step to stage i. Writes: nodes, stages."""
    first = stages.shape[0] * i
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        r, v, L = vec(b.start_r), vec(b.start_v), vec(b.start_L)
        g = (0.0, 0.0, 0.0)
        for j in range(i):
            a, s = h * A[first + j], stages[j, n]
            r = add_scaled(r, a, vec(s.rate_r))
            g = add_scaled(g, a, vec(s.rate_turn))
            v = add_scaled(v, a, vec(s.rate_v))
            L = add_scaled(L, a, vec(s.rate_L))
        put(stages[i, n].turn, g)
        put(b.r, r)
        put(b.v, v)
        put(b.L, L)
        rotate_by_cayley(b.start_q, g, b.q)
        write_matrix(b.q, b.A)


@kernel
def displace_by_joints(nodes):
    """Move bodies by M^-1 D^T lambda, as a displacement. Writes: nodes.r, q, A."""
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        put(b.r, add_scaled(vec(b.r), b.mass_inv, vec(b.joint_force)))
        turn = matvec_t(b.A, matvec(b.W, vec(b.joint_torque)))
        rotate_by_cayley(b.q, scale(0.5, turn), b.q)
        write_matrix(b.q, b.A)


@kernel
def fastest_point(nodes, size):
    """Largest speed of any body [m/s]; a turn counts at the model's size."""
    fastest = 0.0
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        fastest = max(fastest, norm(vec(b.v)), size * norm(vec(b.w)))
    return fastest


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
def step_error(nodes, stages, E, E_LOW, h, size, speed):
    """Estimated error of the step, over the model's size and its largest speed.

    Hairer, Norsett and Wanner (1993), II.10: a second estimate, of lower order, guards the first.
    """
    worst = 0.0
    for n in range(1, nodes.shape[0]):
        high = deviation(nodes[n], stages, E, n, size, speed)
        low = deviation(nodes[n], stages, E_LOW, n, size, speed)
        if high != 0.0:
            share = low / high
            x = high / sqrt(1.0 + 0.01 * share * share)
            # a NaN must win the comparison
            if not x <= worst:
                worst = x
    return h * worst


@kernel
def deviation(b, stages, E, n, size, speed):
    """Largest of the weighted rates of one body, in units of size and speed [1/s]."""
    zero = (0.0, 0.0, 0.0)
    r, g, v, L = zero, zero, zero, zero
    for j in range(stages.shape[0]):
        s = stages[j, n]
        r = add_scaled(r, E[j], vec(s.rate_r))
        g = add_scaled(g, E[j], vec(s.rate_turn))
        v = add_scaled(v, E[j], vec(s.rate_v))
        L = add_scaled(L, E[j], vec(s.rate_L))
    spin = size * norm(matvec(b.W, L))
    return norm(r) / size + 2.0 * norm(g) + (norm(v) + spin) / speed


@kernel
def add_outside(clock, stages, A, h):
    """Impulses from outside and the work of prescribed motions over the step. Writes: clock."""
    count = stages.shape[0]
    first = count * (count - 1)
    for j in range(count):
        a, outside = h * A[first + j], stages[j, 0]
        add_to(clock.impulse, scale(a, vec(outside.rate_v)))
        add_to(clock.angular_impulse, scale(a, vec(outside.rate_L)))
        clock.driver_work += a * outside.rate_r[0]


@kernel
def next_length(h, error, tolerance, order):
    """Length of the next step, or of another attempt, from the error of this one [s]."""
    if error <= 0.0:
        return 5.0 * h
    if not error < 1e300:
        return 0.1 * h
    return h * min(5.0, max(0.2, 0.9 * (tolerance / error) ** (1.0 / order)))
