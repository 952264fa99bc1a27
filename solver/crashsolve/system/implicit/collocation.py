"""Stages of an implicit Runge-Kutta step: their residuals, and the corrections.

    Y_i = y + h sum_j a_ij k(Y_j),   A = T U,   T lower and U unit upper triangular
    (I - h t_ii J) dY_i = h sum_j a_ij k_j - (Y_i - y) + h sum_(j<i) t_ij J dY_j

One stage after the other is solved, with real numbers and a matrix of one stage's size. Consequence
to test: for the methods of Radau the error falls to at most 0.37 of itself with every iteration, on
any linear problem whose exact solution does not grow, and to 0.15 on a damper.

Reference: van der Houwen and de Swart (1997), SIAM J. Sci. Comput. 18, 41-55.
"""

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.rotation import rotate_by_cayley, write_matrix, write_world_tensor
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, norm, put, scale, sub, vec


@kernel
def store_spin_rates(nodes, stages, i):
    """Angular accelerations of all bodies at stage i. Writes: stages."""
    for n in range(1, nodes.shape[0]):
        b = nodes[n]
        torque = add(vec(b.torque), vec(b.joint_torque))
        put(stages[i, n].rate_w, matvec(b.W, sub(torque, cross(vec(b.w), vec(b.L)))))


@kernel
def save_accelerations(stages):
    """Accelerations of the previous step, which predict the next. Writes: stages.past_*."""
    for i in range(1, stages.shape[0]):
        for n in range(1, stages.shape[1]):
            s = stages[i, n]
            put(s.past_v, vec(s.rate_v))
            put(s.past_w, vec(s.rate_w))


@kernel
def predict_stages(nodes, stages, A, C, h, ratio):
    """Predict all stages by the polynomial through the accelerations of the last step.

    `ratio` is the length of this step over that one; 0 holds the accelerations of the start.
    Writes: stages.
    """
    for n in range(1, nodes.shape[0]):
        for i in range(1, stages.shape[0]):
            extrapolate(stages, C, n, i, ratio)
        for i in range(1, stages.shape[0]):
            _, _, change_v, change_w = sum_rates(stages, n, A, i, h)
            put(stages[i, n].change_v, change_v)
            put(stages[i, n].change_w, change_w)
            predict_rates(nodes[n], stages[i, n], C[i] * h)
        for i in range(1, stages.shape[0]):
            displacement_r, rotation, _, _ = sum_rates(stages, n, A, i, h)
            put(stages[i, n].displacement_r, displacement_r)
            put(stages[i, n].rotation, rotation)


@kernel
def extrapolate(stages, C, n, i, ratio):
    """Accelerations of stage i from the three stages of the step before. Writes: stages.rate_*."""
    s = stages[i, n]
    if ratio == 0.0:
        put(s.rate_v, vec(stages[0, n].rate_v))
        put(s.rate_w, vec(stages[0, n].rate_w))
        return
    x, v, w = 1.0 + ratio * C[i], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for j in range(1, stages.shape[0]):
        weight = 1.0
        for k in range(1, stages.shape[0]):
            if k != j:
                weight *= (x - C[k]) / (C[j] - C[k])
        v = add_scaled(v, weight, vec(stages[j, n].past_v))
        w = add_scaled(w, weight, vec(stages[j, n].past_w))
    put(s.rate_v, v)
    put(s.rate_w, w)


@kernel
def sum_rates(stages, n, A, i, h):
    """Changes of position, Cayley vector, velocity and spin up to stage i, without the start's."""
    r = g = v = w = (0.0, 0.0, 0.0)
    for j in range(1, stages.shape[0]):
        r, g, v, w = add_rates(r, g, v, w, h * A[stages.shape[0] * i + j], stages[j, n])
    return r, g, v, w


@inlined
def add_rates(r, g, v, w, t, s):
    """Add the changes over a time t at the rates of stage s."""
    return (
        add_scaled(r, t, vec(s.rate_r)),
        add_scaled(g, t, vec(s.rate_rotation)),
        add_scaled(v, t, vec(s.rate_v)),
        add_scaled(w, t, vec(s.rate_w)),
    )


@kernel
def predict_rates(b, s, t):
    """Velocity, and rate of the Cayley vector, of a stage at time t. Writes: s."""
    put(s.rate_r, add(vec(b.start_v), vec(s.change_v)))
    start = matvec_t(b.start_A, start_spin(b))
    omega, g = add(start, matvec_t(b.start_A, vec(s.change_w))), scale(0.5 * t, start)
    # the spin is in the axes of the start, hence the sign of the cross product
    rate = add_scaled(sub(omega, cross(g, omega)), dot(g, omega), g)
    put(s.rate_rotation, scale(0.5, rate))


@kernel
def start_spin(b):
    """Angular velocity at the start of the step [rad/s]."""
    return matvec(b.start_A, matvec(b.J_inv, matvec_t(b.start_A, vec(b.start_L))))


@kernel
def move_to_stage(nodes, stages, i):
    """Move all bodies to the present configuration of stage i. Writes: nodes."""
    for n in range(1, nodes.shape[0]):
        b, s = nodes[n], stages[i, n]
        put(b.r, add(vec(b.start_r), vec(s.displacement_r)))
        put(b.v, add(vec(b.start_v), vec(s.change_v)))
        rotate_by_cayley(b.start_q, vec(s.rotation), b.q)
        write_matrix(b.q, b.A)
        write_world_tensor(b.A, b.J_inv, b.W)
        put(b.w, add(start_spin(b), vec(s.change_w)))
        put(b.L, matvec(b.A, matvec(b.J, matvec_t(b.A, vec(b.w)))))


@kernel
def stage_residual(nodes, stages, A, T, i, h):
    """Residual of stage i, with the corrections of the stages before it. Writes: stages.right_*."""
    count = stages.shape[0]
    for n in range(1, nodes.shape[0]):
        s = stages[i, n]
        r, g, v, w = sum_rates(stages, n, A, i, h)
        r, g = sub(r, vec(s.displacement_r)), sub(g, vec(s.rotation))
        v, w = sub(v, vec(s.change_v)), sub(w, vec(s.change_w))
        for j in range(1, i):
            t, other = h * T[count * i + j], stages[j, n]
            r = add_scaled(r, t, vec(other.slope_r))
            g = add_scaled(g, t, vec(other.slope_rotation))
            v = add_scaled(v, t, vec(other.slope_v))
            w = add_scaled(w, t, vec(other.slope_w))
        put(s.right_r, r)
        put(s.right_rotation, g)
        put(s.right_v, v)
        put(s.right_w, w)


@kernel
def embedded_difference(nodes, stages, E, i, h):
    """The difference from the embedded method as residual of stage i. Writes: stages.right_*."""
    for n in range(1, nodes.shape[0]):
        s, zero = stages[i, n], (0.0, 0.0, 0.0)
        r, g, v, w = zero, zero, zero, zero
        for j in range(stages.shape[0]):
            r, g, v, w = add_rates(r, g, v, w, h * E[j], stages[j, n])
        put(s.right_r, r)
        put(s.right_rotation, g)
        put(s.right_v, v)
        put(s.right_w, w)


@kernel
def correct_stage(nodes, stages, i):
    """Add the correction to stage i. Writes: stages."""
    for n in range(1, nodes.shape[0]):
        s = stages[i, n]
        add_to(s.displacement_r, vec(s.right_r))
        add_to(s.rotation, vec(s.right_rotation))
        add_to(s.change_v, vec(s.right_v))
        add_to(s.change_w, vec(s.right_w))


@kernel
def correction_size(nodes, stages, i, size, speed):
    """Largest correction of any body, in units of the model's size and speed."""
    worst = 0.0
    for n in range(1, nodes.shape[0]):
        s = stages[i, n]
        spin = size * norm(vec(s.right_w))
        x = norm(vec(s.right_r)) / size + 2.0 * norm(vec(s.right_rotation))
        x += (norm(vec(s.right_v)) + spin) / speed
        if not x <= worst:
            worst = x
    return worst
