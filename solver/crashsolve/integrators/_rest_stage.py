"""Step from rest to rest: stages of the stepper `_implicit` for quasi-static runs.

    g(q) + D^T lambda = M a,   q = q_0 + h^2/2 a,   Phi(q) = 0        at the time `clock.goal`

by Newton's method with a new matrix in every iteration. With control.searches a correction
d is shortened to the share s of it at which its power P is a part of that at its start, by
bisection,

    P(s) = d . (g + D^T lambda - M a) at q + s d,   |P(s)| <= LESS |P(0)|

since the energy of elements that yield is least where P = 0, and a full correction may go far
beyond. h is no time but the size of 2 M / h^2, which
stands in for stiffness where there is none; nothing moves, and no law sees a velocity. Consequence
to test: as h grows, one step leads to the equilibrium.

Reference: Crisfield (1991), Non-linear Finite Element Analysis of Solids and Structures, vol. 1, 9.
"""

from crashsolve.foundation.columns import add_to, matvec, matvec_t
from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.rotation import rotate_by_vector, write_matrix, write_world_tensor
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.integrators._alpha_stage import end_factor
from crashsolve.integrators._positions import evaluate
from crashsolve.model.clock import UNSOLVED
from crashsolve.system.constraints import scatter_trial, worst_residual
from crashsolve.system.implicit.compliance import factor_compliant, linearise
from crashsolve.system.implicit.generalized_alpha import acceleration_residual
from crashsolve.system.implicit.global_matrix import solve_corrections
from crashsolve.system.implicit.stages import store_external
from crashsolve.system.kinetics import clear_forces
from crashsolve.system.loops.elements import save_elements
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import jacobian, residual
from crashsolve.system.loops.tangents import assemble_stiffness, tangents
from crashsolve.system.placeholders import JOINTS

CAN_CLOSE_STAGES = False  # its only stage is closed
MAX_ITERATIONS = 40
# largest rotation [rad] and displacement (over the model's size) of a correction
LARGEST_ROTATION, LARGEST_DISPLACEMENT = 0.3, 0.2
# a correction that falls no more is round-off below this, in the model's size or rad
STAGNATION_TOLERANCE = 1e-9
# the predicted error of the iteration over the allowed remaining displacement
SHARE_OF_TOLERANCE = 0.03
# bisections of a correction, and the share of the power along it that may be left: a little less
# than all, since Newton's method does the rest (Crisfield, 9.2)
BISECTIONS, POWER_LEFT = 8, 0.8


@stage
def open_step(clock, nodes, rows, scene):
    """Start from rest. Writes: scene.stages."""
    zero = (0.0, 0.0, 0.0)
    for n in range(nodes.shape[0]):
        end = scene.stages[1, n]
        put(end.rate_v, zero)
        put(end.rate_w, zero)
    save_elements(scene)


@stage
def solve_stages(h, _reuses_factors, _closes_stages, clock, nodes, rows, saddle, scene):
    """The equilibrium, by iteration. Returns whether that converges.

    Writes: nodes, rows, scene.stages, new histories, clock.value (the last correction).
    """
    control = scene.control[0]
    tt = 0.5 * h * h
    compliant, factor = scene.compliant_0, end_factor(scene)
    for k in range(rows.shape[0]):
        rows[k].trial = rows[k].multiplier
    previous, power, converged = 1e300, 0.0, False
    for count in range(MAX_ITERATIONS):
        evaluate_trial(h, tt, clock, nodes, rows, scene)
        tangents(clock, nodes, scene.curves, compliant, scene)
        assemble_stiffness(h, clock, nodes, scene.curves, factor, scene)
        linearise(rows, compliant, nodes, 0.0, tt)
        factor_compliant(factor, compliant, rows.shape[0], tt, 0.0)
        acceleration_residual(nodes, scene.stages)
        for k in range(rows.shape[0]):
            compliant[k].right = -rows[k].phi / tt
        solve_corrections(nodes, rows, scene.stages, compliant, factor)
        if control.searches == 1:
            power = power_of(nodes, scene.stages)
        worst, motion = correct_positions(scene.stages, tt, control.length)
        clock.iterations += 1
        clock.value = worst
        share = min(worst / previous, 1.0) if count > 0 else 1.0
        if worst * share <= SHARE_OF_TOLERANCE * control.tolerance * motion:
            converged = True
            break
        if not worst < 1e6:
            break
        if worst <= STAGNATION_TOLERANCE and not worst < 0.5 * previous:
            converged = True
            break
        # the first correction moves drivers to their prescribed positions
        if control.searches == 1 and count > 0:
            line_search(power, h, tt, clock, nodes, rows, scene)
        previous = worst
    evaluate_trial(h, tt, clock, nodes, rows, scene)
    if JOINTS:
        for k in range(rows.shape[0]):
            rows[k].multiplier = rows[k].trial
        gap, clock.index = worst_residual(rows)
        clock.residual = max(clock.residual, gap) if converged else clock.residual
        converged = converged and gap <= control.constraint_tolerance
    if not converged:
        clock.fault = UNSOLVED
    return converged


@stage
def line_search(start_power, h, tt, clock, nodes, rows, scene):
    """Shorten the last correction, at the start of which the power was `start_power`.

    Writes: nodes, rows, scene.stages.
    """
    low, high, share = 0.0, 1.0, 1.0
    for _ in range(BISECTIONS):
        evaluate_trial(h, tt, clock, nodes, rows, scene)
        power = power_of(nodes, scene.stages)
        if abs(power) <= POWER_LEFT * abs(start_power) or (
            share == 1.0 and power * start_power > 0.0
        ):
            break
        if power * start_power < 0.0:
            high = share
        else:
            low = share
        middle = 0.5 * (low + high)
        add_correction(scene.stages, middle - share)
        share = middle


@kernel
def power_of(nodes, stages):
    """Residual force along the last correction, over a time [N m/s^2].

    The forces are those at the present positions.
    """
    power = 0.0
    for n in range(1, nodes.shape[0]):
        b, end = nodes[n], stages[1, n]
        force = add(vec(b.force), vec(b.joint_force))
        torque = add(vec(b.torque), vec(b.joint_torque))
        inertia = matvec(b.A, matvec(b.J, matvec_t(b.A, vec(end.rate_w))))
        power += dot(add_scaled(force, -1.0 / b.mass_inv, vec(end.rate_v)), vec(end.right_v))
        power += dot(sub(torque, inertia), vec(end.right_w))
    return power


@kernel
def add_correction(stages, share):
    """Add a share, which may be negative, of the last correction. Writes: stages."""
    for n in range(1, stages.shape[1]):
        end = stages[1, n]
        add_to(end.rate_v, scale(share, vec(end.right_v)))
        add_to(end.rate_w, scale(share, vec(end.right_w)))


@kernel
def correct_positions(stages, tt, size):
    """Add the corrections, cut where they go too far. Returns the largest, and the largest motion.

    Both in the model's size and rad; those that are added remain. Writes: stages.
    """
    worst, motion, excess = 0.0, 0.0, 1.0
    for n in range(1, stages.shape[1]):
        end = stages[1, n]
        x, rotation = tt * norm(vec(end.right_v)) / size, tt * norm(vec(end.right_w))
        # a NaN must win the comparison
        if not x + rotation <= worst:
            worst = x + rotation
        excess = max(excess, x / LARGEST_DISPLACEMENT, rotation / LARGEST_ROTATION)
    for n in range(1, stages.shape[1]):
        end = stages[1, n]
        put(end.right_v, scale(1.0 / excess, vec(end.right_v)))
        put(end.right_w, scale(1.0 / excess, vec(end.right_w)))
        add_to(end.rate_v, vec(end.right_v))
        add_to(end.rate_w, vec(end.right_w))
        motion = max(motion, tt * (norm(vec(end.rate_v)) / size + norm(vec(end.rate_w))))
    return worst, motion


@stage
def evaluate_trial(h, tt, clock, nodes, rows, scene):
    """Forces and constraints where the iteration stands. Writes: nodes, rows."""
    move_to_trial(nodes, scene.stages, tt)
    clock.opens, clock.closes, clock.ends = 1, 0, 1
    clock.lead, clock.share = 0.5 * h, 0.0
    clear_forces(nodes)
    force_pass(clock, clock.goal, h, nodes, rows, scene.curves, scene)
    if JOINTS:
        residual(clock.current, clock.goal, nodes, rows, scene.curves, scene)
        jacobian(clock.current, clock.goal, nodes, rows, scene.curves, scene)
    scatter_trial(rows, nodes)


@kernel
def move_to_trial(nodes, stages, tt):
    """Set all bodies to the positions of the iteration, at rest. Writes: nodes."""
    zero = (0.0, 0.0, 0.0)
    for n in range(1, nodes.shape[0]):
        b, end = nodes[n], stages[1, n]
        put(b.r, add_scaled(vec(b.start_r), tt, vec(end.rate_v)))
        rotate_by_vector(b.start_q, matvec_t(b.start_A, scale(tt, vec(end.rate_w))), b.q)
        write_matrix(b.q, b.A)
        write_world_tensor(b.A, b.J_inv, b.W)
        put(b.v, zero)
        put(b.w, zero)
        put(b.L, zero)


@stage
def evaluate_end(h, clock, nodes, rows, saddle, scene):
    """Forces and losses at the end of the step. Writes: nodes, histories, scene.stages."""
    clock.opens = clock.closes = clock.ends = 1
    clock.lead = clock.share = 0.5 * h
    evaluate(clock.goal, h, clock, nodes, rows, saddle, scene)
    store_external(nodes, rows, scene.stages, 1)


@kernel
def estimate(h, clock, nodes, scene, size, speed):
    """Nothing: the length of a step from rest is given."""
    return 0.0
