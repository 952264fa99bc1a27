"""Stage of generalized-alpha, for the stepper `_implicit` (system/implicit/generalized_alpha.py).

    accelerations of the end and both multipliers by Newton's method: lambda for D v = nu, eta for
    Phi = 0

Consequence to test: a spring far too stiff for the step dies away, order 2 for a soft one.

Reference: Bruels, Cardona and Arnold (2012), Mechanism and Machine Theory 48, 121-137.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.sparse.bordered import Bordered
from crashsolve.foundation.sparse.saddle import compliant_saddle
from crashsolve.integrators._positions import begin_contacts, evaluate, project
from crashsolve.integrators.generalized_alpha import ESTIMATE, ORDER
from crashsolve.model.clock import UNSOLVED
from crashsolve.system.constraints import scatter_trial, velocity_residual
from crashsolve.system.implicit.collocation import correction_size, keep_spin_rates
from crashsolve.system.implicit.compliance import (
    answer_rows,
    ask_rates,
    close_at_end,
    factor_compliant,
    linearise,
    solve_stage,
)
from crashsolve.system.implicit.generalized_alpha import (
    alpha_weights,
    ask_positions,
    guess_end,
    improve_accelerations,
    miss_estimate,
    missing_accelerations,
    open_accelerations,
    stand_at_end,
)
from crashsolve.system.implicit.iteration import (
    PASSES,
    diverges_early,
    enough_beside,
    is_near,
    note_pass,
)
from crashsolve.system.implicit.stages import keep_outside, keep_rates, reference_speed
from crashsolve.system.kinetics import clear_forces, take_deferred
from crashsolve.system.loops.elements import keep_elements
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import jacobian, residual
from crashsolve.system.loops.tangents import bend, renew, tangents
from crashsolve.system.placeholders import ASSEMBLED, CONTACTS, JOINTS

FAR = 4.0  # a step longer than so many of the last is not guessed from it
# the least share of the error that a pass leaves, where the problem is stiff
SHARE = 0.1


@stage
def open_step(clock, nodes, rows, scene):
    """Accelerations at the start of the step. Writes: scene.stages, rows.trial."""
    keep_rates(nodes, rows, scene.stages, 0)
    keep_spin_rates(nodes, scene.stages, 0)
    open_accelerations(scene.stages, is_smooth(clock))
    if ASSEMBLED:
        keep_elements(scene)


@kernel
def is_smooth(clock):
    """Whether the last step says something about this one."""
    return clock.step > 0.0 and clock.kinked == 0


@stage
def pass_stages(h, kept, clock, nodes, rows, saddle, scene):
    """The end of the step, by iteration. Returns whether that converges and the joints close.

    `kept`: with the factors at hand.

    Writes: nodes, rows, scene.stages, new histories.
    """
    control = scene.control[0]
    weights = alpha_weights(control.spectral_radius, h)
    _, _, _, t, tt = weights
    # tangents by the acceleration of the end itself
    t, tt = weights[0] * t, weights[0] * tt
    ratio = h / clock.step if is_smooth(clock) else 1.0
    guess_end(scene.stages, ratio if ratio < FAR else 0.0)
    for k in range(rows.shape[0]):
        rows[k].trial = rows[k].multiplier
    compliant, factor = scene.compliant_0, end_factor(scene)
    speed = reference_speed(clock)
    previous, converged, enough = 1e300, False, enough_beside(h, clock, control, ORDER, ESTIMATE)
    if ASSEMBLED:
        share = 0.0
    for count in range(PASSES):
        stand_at_end(nodes, scene.stages, weights, h, ratio)
        visit_end(h, clock, nodes, rows, scene)
        if count == 0 and not kept:
            tangents(clock, nodes, scene.curves, compliant, scene)
            if ASSEMBLED:
                bend(h, clock, nodes, scene.curves, factor, scene)
            clock.factored = h
            linearise(rows, compliant, nodes, t, tt)
            factor_compliant(factor, compliant, rows.shape[0], tt, t)
        # elements bend far within a step: tangents of its start do not serve
        if ASSEMBLED and count > 0 and (share > 3.0 * SHARE or previous > 0.01):
            renew(h, clock, nodes, compliant, factor, t, tt, scene)
        missing_accelerations(nodes, scene.stages)
        velocity_residual(rows, nodes)
        ask_rates(rows, compliant, scene.stages, t)
        answer_rows(nodes, rows, scene.stages, compliant, factor)
        worst = improve_accelerations(scene.stages, t, tt, control.length, speed)
        if JOINTS:
            ask_positions(rows, compliant)
            worst += close_at_end(scene.stages, compliant, factor, control.length)
        share = note_pass(clock, count, worst, previous, SHARE)
        converged = is_near(count, share, worst, previous, enough, control, scene.stages, speed)
        if converged or diverges_early(count, worst, previous):
            break
        previous = worst
    stand_at_end(nodes, scene.stages, weights, h, ratio)
    if not converged:
        clock.fault = UNSOLVED
        return False
    if not JOINTS:
        return True
    for k in range(rows.shape[0]):
        rows[k].multiplier = rows[k].trial
    return project(clock.time + h, clock, nodes, rows, saddle, scene)


@stage
def visit_end(h, clock, nodes, rows, scene):
    """Forces and constraints at the end, with the multipliers so far. Writes: nodes, rows."""
    clock.opens, clock.closes, clock.ends = 1, 0, 1
    clock.lead, clock.share = 0.5 * h, 0.0
    clear_forces(nodes)
    force_pass(clock, clock.time + h, h, nodes, rows, scene.curves, scene)
    if CONTACTS:
        take_deferred(nodes, -1.0)
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
def arrive(h, clock, nodes, rows, saddle, scene):
    """Forces and losses at the end of the step. Writes: nodes, histories, scene.stages."""
    clock.opens = clock.closes = clock.ends = 1
    clock.lead = clock.share = 0.5 * h
    evaluate(clock.time + h, h, clock, nodes, rows, saddle, scene)
    keep_outside(nodes, rows, scene.stages, 1)
    if CONTACTS:
        begin_contacts(clock.time + h, clock, nodes, rows, saddle, scene)


@stage
def estimate(h, clock, nodes, scene, size, speed):
    """Estimated error of the step; stiff components are damped as by the method.

    Writes: scene.stages.right_*.
    """
    miss_estimate(nodes, scene.stages, h, clock.step, is_smooth(clock))
    t = alpha_weights(scene.control[0].spectral_radius, h)[3]
    for k in range(scene.rows.shape[0]):
        scene.compliant_0[k].right = 0.0
    joint_rows = scene.rows.shape[0]
    solve_stage(nodes, scene.stages, 1, scene.compliant_0, end_factor(scene), joint_rows, t)
    return correction_size(nodes, scene.stages, 1, size, speed)
