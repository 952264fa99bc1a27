"""Generalized-alpha: accelerations of the new time by iteration, with Phi = 0 as an equation.

    (1 - a_m) a_1 + a_m a_0 = (1 - a_f) v_dot_1 + a_f v_dot_0
    v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1)
    rotation or displacement = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1) + M^-1 D^T eta
    M v_dot_1 = g_1 + D_1^T lambda_1,   D_1 v_1 = nu_1,   Phi(q_1) = 0

a is a mean of accelerations, the one at t + (a_f - a_m) h. With rho, the share of the fastest
vibration that a step leaves: a_m = (2 rho - 1)/(rho + 1), a_f = rho/(rho + 1),
gamma = 1/2 + a_f - a_m, beta = (gamma + 1/2)^2 / 4. The rotation is a vector in world axes, so
a body that spins freely about one axis turns exactly.

References: Chung and Hulbert (1993), J. Appl. Mech. 60, 371-375; Arnold and Bruels (2007),
Multibody System Dynamics 18, 185-202; Bruels, Cardona and Arnold (2012), Mechanism and Machine
Theory 48, 121-137 (Lie group).
"""

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.rotation import rotate_by_vector, write_matrix, write_world_tensor
from crashsolve.foundation.vec3 import add, add_scaled, cross, norm, put, scale, sub, vec
from crashsolve.system.implicit.collocation import start_spin


@kernel
def alpha_weights(rho, h):
    """Weights of v_dot_1, v_dot_0 and a_0 in a_1; derivatives of velocity and displacement by
    v_dot_1.
    """
    a_m, a_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + a_f - a_m
    beta = 0.25 * (gamma + 0.5) ** 2
    new, old, mean = (1.0 - a_f) / (1.0 - a_m), a_f / (1.0 - a_m), -a_m / (1.0 - a_m)
    return new, old, mean, gamma * h, beta * h * h


@kernel
def open_accelerations(stages, smooth):
    """Accelerations at the start: those of the last step's end, where it was smooth.

    Writes: stages.
    """
    for n in range(1, stages.shape[1]):
        s, end = stages[0, n], stages[1, n]
        if smooth:
            # keep_rates does not include the multipliers of the step
            put(s.past_v, vec(end.past_v))
            put(s.past_w, vec(end.past_w))
            put(s.rate_v, vec(end.rate_v))
            put(s.rate_w, vec(end.rate_w))
            put(s.mean_v, vec(end.mean_v))
            put(s.mean_w, vec(end.mean_w))
        else:
            put(s.past_v, vec(s.rate_v))
            put(s.past_w, vec(s.rate_w))
            put(s.mean_v, vec(s.rate_v))
            put(s.mean_w, vec(s.rate_w))
        # history for the next step
        put(end.past_v, vec(s.rate_v))
        put(end.past_w, vec(s.rate_w))


@kernel
def predict_end(stages, ratio):
    """Predict accelerations at the end on the line through the last two. Writes: stages."""
    for n in range(1, stages.shape[1]):
        s, end = stages[0, n], stages[1, n]
        put(end.closing_r, (0.0, 0.0, 0.0))
        put(end.closing_w, (0.0, 0.0, 0.0))
        put(end.rate_v, add_scaled(vec(s.rate_v), ratio, sub(vec(s.rate_v), vec(s.past_v))))
        put(end.rate_w, add_scaled(vec(s.rate_w), ratio, sub(vec(s.rate_w), vec(s.past_w))))


@kernel
def mean_of(now, before, mean, weights, ratio):
    """a_1, and a_0 for the length of this step, `ratio` times the last."""
    start = add_scaled(before, ratio, sub(mean, before))
    new, old, reuses_factors, _, _ = weights
    return add_scaled(add_scaled(scale(reuses_factors, start), old, before), new, now), start


@kernel
def move_to_end(nodes, stages, weights, h, ratio):
    """Move all bodies to the configuration that follows from the accelerations of the end.

    Writes: nodes, stages.
    """
    _, _, _, t, tt = weights
    for n in range(1, nodes.shape[0]):
        b, s, end = nodes[n], stages[0, n], stages[1, n]
        a_1, a_0 = mean_of(vec(end.rate_v), vec(s.rate_v), vec(s.mean_v), weights, ratio)
        displacement = add_scaled(scale(h, vec(b.start_v)), 0.5 * h * h - tt, a_0)
        put(end.displacement_r, add(add_scaled(displacement, tt, a_1), vec(end.closing_r)))
        put(end.change_v, add_scaled(scale(h - t, a_0), t, a_1))
        put(end.mean_v, a_1)
        put(b.r, add(vec(b.start_r), vec(end.displacement_r)))
        put(b.v, add(vec(b.start_v), vec(end.change_v)))
        a_1, a_0 = mean_of(vec(end.rate_w), vec(s.rate_w), vec(s.mean_w), weights, ratio)
        w = start_spin(b)
        rotation = add_scaled(add_scaled(scale(h, w), 0.5 * h * h - tt, a_0), tt, a_1)
        body_rotation = matvec_t(b.start_A, add(rotation, vec(end.closing_w)))
        put(end.rotation, scale(0.5, body_rotation))
        put(end.change_w, add_scaled(scale(h - t, a_0), t, a_1))
        put(end.mean_w, a_1)
        rotate_by_vector(b.start_q, body_rotation, b.q)
        write_matrix(b.q, b.A)
        spin(b, add(w, vec(end.change_w)))


@kernel
def spin(b, w):
    """Set the angular velocity of a body at its present configuration. Writes: b.W, w, L."""
    write_world_tensor(b.A, b.J_inv, b.W)
    put(b.w, w)
    put(b.L, matvec(b.A, matvec(b.J, matvec_t(b.A, w))))


@kernel
def acceleration_residual(nodes, stages):
    """M^-1 (g + D^T lambda) - v_dot of all bodies. Writes: stages.right_v, right_w."""
    for n in range(1, nodes.shape[0]):
        b, end = nodes[n], stages[1, n]
        force = add(vec(b.force), vec(b.joint_force))
        torque = add(vec(b.torque), vec(b.joint_torque))
        put(end.right_v, sub(scale(b.mass_inv, force), vec(end.rate_v)))
        rate = matvec(b.W, sub(torque, cross(vec(b.w), vec(b.L))))
        put(end.right_w, sub(rate, vec(end.rate_w)))


@kernel
def set_position_right_sides(rows, compliant):
    """Right sides for Phi = 0 of joints; none of springs. Writes: compliant."""
    for k in range(compliant.shape[0]):
        compliant[k].right = -rows[k].phi if k < rows.shape[0] else 0.0


@kernel
def correct_accelerations(stages, t, tt, size, speed):
    """Add the corrections. Returns the largest, in the model's size and speed. Writes: stages."""
    worst = 0.0
    for n in range(1, stages.shape[1]):
        end = stages[1, n]
        add_to(end.rate_v, vec(end.right_v))
        add_to(end.rate_w, vec(end.right_w))
        x, w = norm(vec(end.right_v)), norm(vec(end.right_w))
        x = (tt / size + t / speed) * x + (tt + t * size / speed) * w
        if not x <= worst:
            worst = x
    return worst


@kernel
def estimate_residual(nodes, stages, h, before, smooth):
    """The step less that of the parabola through three accelerations, as residual of the end.

    `before` is the length of the last step; after a kink the parabola is a line, and the estimate
    of lower order. Writes: stages.right_*.
    """
    for n in range(1, nodes.shape[0]):
        b, s, end = nodes[n], stages[0, n], stages[1, n]
        v, r = parabola(vec(s.past_v), vec(s.rate_v), vec(end.rate_v), h, before, smooth)
        put(end.right_v, sub(vec(end.change_v), v))
        put(end.right_r, sub(vec(end.displacement_r), add_scaled(r, h, vec(b.start_v))))
        v, r = parabola(vec(s.past_w), vec(s.rate_w), vec(end.rate_w), h, before, smooth)
        put(end.right_w, sub(vec(end.change_w), v))
        rotation = matvec_t(b.start_A, add_scaled(r, h, start_spin(b)))
        put(end.right_rotation, sub(vec(end.rotation), scale(0.5, rotation)))


@kernel
def parabola(past, start, end, h, before, smooth):
    """Changes of velocity and of displacement by accelerations on a parabola."""
    curvature = scale(1.0 / h, sub(end, start))
    if smooth:
        curvature = sub(curvature, scale(1.0 / before, sub(start, past)))
    curvature = scale(1.0 / (h + before), curvature)
    v = add_scaled(scale(0.5 * h, add(start, end)), -(h**3) / 6.0, curvature)
    r = add_scaled(scale(h * h / 3.0, start), h * h / 6.0, end)
    return v, add_scaled(r, -(h**4) / 12.0, curvature)
