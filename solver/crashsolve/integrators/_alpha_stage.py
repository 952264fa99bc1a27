"""Stage of generalized-alpha, for the stepper `_implicit` (system/implicit/generalized_alpha.py).

    accelerations of the end and both multipliers by Newton's method: lambda for D v = nu, eta for
    Phi = 0

Consequence to test: a spring far too stiff for the step dies away, order 2 for a soft one.

Reference: Bruels, Cardona and Arnold (2012), Mechanism and Machine Theory 48, 121-137.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.sparse.bordered import Bordered
from crashsolve.foundation.sparse.saddle import compliant_saddle
from crashsolve.integrators._positions import (
    begin_contacts,
    closing_tolerance,
    evaluate,
    project,
)
from crashsolve.integrators.generalized_alpha import ESTIMATE, ORDER
from crashsolve.model.clock import UNSOLVED
from crashsolve.system.constraints import scatter_trial, velocity_residual
from crashsolve.system.implicit.collocation import correction_size, store_spin_rates
from crashsolve.system.implicit.compliance import (
    correct_closure,
    factor_compliant,
    linearise,
    set_rate_right_sides,
    solve_corrections,
    solve_stage,
)
from crashsolve.system.implicit.generalized_alpha import (
    acceleration_residual,
    alpha_weights,
    correct_accelerations,
    estimate_residual,
    move_to_end,
    open_accelerations,
    predict_end,
    set_position_right_sides,
)
from crashsolve.system.implicit.iteration import (
    MAX_ITERATIONS,
    count_iteration,
    diverges_early,
    has_converged,
    iteration_tolerance,
)
from crashsolve.system.implicit.stages import reference_speed, store_external, store_rates
from crashsolve.system.kinetics import apply_deferred, clear_forces
from crashsolve.system.loops.elements import save_elements
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import jacobian, residual
from crashsolve.system.loops.tangents import assemble_stiffness, tangents, update_tangents
from crashsolve.system.placeholders import ASSEMBLED, CONTACTS, JOINTS

CAN_CLOSE_STAGES = False  # its only stage, the end of the step, is closed
MAX_STEP_RATIO = 4.0  # times the last step; a longer one is not extrapolated from it
# least contraction that the iteration is credited with, where the problem is stiff
LEAST_CONTRACTION = 0.1


@stage
def open_step(clock, nodes, rows, scene):
    """Accelerations at the start of the step. Writes: scene.stages, rows.trial."""
    store_rates(nodes, rows, scene.stages, 0)
    store_spin_rates(nodes, scene.stages, 0)
    open_accelerations(scene.stages, is_smooth(clock))
    if ASSEMBLED:
        save_elements(scene)


@kernel
def is_smooth(clock):
    """Whether accelerations are continuous from the last step to this one."""
    return clock.step > 0.0 and clock.kinked == 0


@stage
def solve_stages(h, reuses_factors, _closes_stages, clock, nodes, rows, saddle, scene):
    """The end of the step, by iteration. Returns whether that converges and the joints close.

    `reuses_factors`: with the factors of an earlier step.

    Writes: nodes, rows, scene.stages, new histories.
    """
    control = scene.control[0]
    weights = alpha_weights(control.spectral_radius, h)
    _, _, _, t, tt = weights
    # tangents by the acceleration of the end itself
    t, tt = weights[0] * t, weights[0] * tt
    ratio = h / clock.step if is_smooth(clock) else 1.0
    predict_end(scene.stages, ratio if ratio < MAX_STEP_RATIO else 0.0)
    for k in range(rows.shape[0]):
        rows[k].trial = rows[k].multiplier
    compliant, factor = scene.compliant_0, end_factor(scene)
    speed = reference_speed(clock)
    previous, converged = 1e300, False
    allowed = iteration_tolerance(h, clock, control, ORDER, ESTIMATE)
    if ASSEMBLED:
        contraction = 0.0
    for count in range(MAX_ITERATIONS):
        move_to_end(nodes, scene.stages, weights, h, ratio)
        evaluate_trial(h, clock, nodes, rows, scene)
        if count == 0 and not reuses_factors:
            tangents(clock, nodes, scene.curves, compliant, scene)
            if ASSEMBLED:
                assemble_stiffness(h, clock, nodes, scene.curves, factor, scene)
            clock.factored = h
            linearise(rows, compliant, nodes, t, tt)
            factor_compliant(factor, compliant, rows.shape[0], tt, t)
        # elements deform much within a step: tangents of its start are too inaccurate
        if ASSEMBLED and count > 0 and (contraction > 3.0 * LEAST_CONTRACTION or previous > 0.01):
            update_tangents(h, clock, nodes, compliant, factor, t, tt, scene)
        acceleration_residual(nodes, scene.stages)
        velocity_residual(rows, nodes)
        set_rate_right_sides(rows, compliant, scene.stages, t)
        solve_corrections(nodes, rows, scene.stages, compliant, factor)
        worst = correct_accelerations(scene.stages, t, tt, control.length, speed)
        if JOINTS:
            set_position_right_sides(rows, compliant)
            worst += correct_closure(scene.stages, compliant, factor, control.length)
        contraction = count_iteration(clock, count, worst, previous, LEAST_CONTRACTION)
        converged = has_converged(
            count, contraction, worst, previous, allowed, control, scene.stages, speed
        )
        if converged or diverges_early(count, worst, previous):
            break
        previous = worst
    move_to_end(nodes, scene.stages, weights, h, ratio)
    if not converged:
        clock.fault = UNSOLVED
        return False
    if not JOINTS:
        return True
    for k in range(rows.shape[0]):
        rows[k].multiplier = rows[k].trial
    return project(clock.time + h, closing_tolerance(control), clock, nodes, rows, saddle, scene)


@stage
def evaluate_trial(h, clock, nodes, rows, scene):
    """Forces and constraints at the end, with the multipliers so far. Writes: nodes, rows."""
    clock.opens, clock.closes, clock.ends = 1, 0, 1
    clock.lead, clock.share = 0.5 * h, 0.0
    clear_forces(nodes)
    force_pass(clock, clock.time + h, h, nodes, rows, scene.curves, scene)
    if CONTACTS:
        apply_deferred(nodes, -1.0)
    if JOINTS:
        residual(clock.current, clock.time + h, nodes, rows, scene.curves, scene)
        jacobian(clock.current, clock.time + h, nodes, rows, scene.curves, scene)
    scatter_trial(rows, nodes)


@kernel
def end_factor(scene):
    """The factor of the step's matrix."""
    updates = scene.compliant_updates
    if ASSEMBLED:
        return Bordered(scene.columns_0, scene.blocks_0, updates, scene.compliant_slots)
    return compliant_saddle(scene, scene.columns_0, scene.blocks_0)


@stage
def evaluate_end(h, clock, nodes, rows, saddle, scene):
    """Forces and losses at the end of the step. Writes: nodes, histories, scene.stages."""
    clock.opens = clock.closes = clock.ends = 1
    clock.lead = clock.share = 0.5 * h
    evaluate(clock.time + h, h, clock, nodes, rows, saddle, scene)
    store_external(nodes, rows, scene.stages, 1)
    if CONTACTS:
        begin_contacts(clock.time + h, clock, nodes, rows, saddle, scene)


@stage
def estimate(h, clock, nodes, scene, size, speed):
    """Estimated error of the step; stiff components are damped as by the method.

    Writes: scene.stages.right_*.
    """
    estimate_residual(nodes, scene.stages, h, clock.step, is_smooth(clock))
    t = alpha_weights(scene.control[0].spectral_radius, h)[3]
    for k in range(scene.rows.shape[0]):
        scene.compliant_0[k].right = 0.0
    joint_rows = scene.rows.shape[0]
    solve_stage(nodes, scene.stages, 1, scene.compliant_0, end_factor(scene), joint_rows, t)
    return correction_size(nodes, scene.stages, 1, size, speed)
