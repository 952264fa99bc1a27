"""Stages of an implicit Runge-Kutta step: stages of the stepper `_implicit`.

    k_i = rates at the position to which sum_j a_ij k_j leads, with the reactions of that position,
    for all stages at once, by iteration with the tangents of springs and contacts

The end of the step is its last stage. Consequence to test: the step of a stiff deck is that of its
motion, for any stiffness.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
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
from crashsolve.integrators.radau_iia_5 import ESTIMATE, ORDER, STAGES
from crashsolve.model.clock import UNSOLVED
from crashsolve.system.constraints import factor_constraints
from crashsolve.system.implicit.collocation import (
    correct_stage,
    correction_size,
    embedded_difference,
    move_to_stage,
    predict_stages,
    save_accelerations,
    stage_residual,
    store_spin_rates,
)
from crashsolve.system.implicit.compliance import factor_compliant, linearise, solve_stage
from crashsolve.system.implicit.iteration import (
    MAX_ITERATIONS,
    count_iteration,
    diverges_early,
    has_converged,
    iteration_tolerance,
)
from crashsolve.system.implicit.stages import reference_speed, store_rates
from crashsolve.system.kinetics import refresh
from crashsolve.system.loops.elements import save_elements
from crashsolve.system.loops.joints import jacobian
from crashsolve.system.loops.tangents import assemble_stiffness, tangents
from crashsolve.system.placeholders import ASSEMBLED, CONTACTS, JOINTS

# stages may be evaluated where the joints are closed
CAN_CLOSE_STAGES = True
# times the last step; a longer one is not extrapolated from it
MAX_STEP_RATIO = 4.0
# least contraction that the iteration is credited with, where the problem is stiff
LEAST_CONTRACTION = 0.3


@stage
def open_step(clock, nodes, rows, scene):
    """Rates at the start of the step. Writes: scene.stages."""
    store_rates(nodes, rows, scene.stages, 0)
    store_spin_rates(nodes, scene.stages, 0)
    save_accelerations(scene.stages)
    if ASSEMBLED:
        save_elements(scene)


@stage
def solve_stages(h, reuses_factors, closes_stages, clock, nodes, rows, saddle, scene):
    """All stages, by iteration. Returns whether they converge and the joints can be closed.

    `reuses_factors`: with the factors of an earlier step; `closes_stages`: with rates of the
    nearest configuration in which the joints are closed.

    Writes: nodes, rows, scene.stages, new histories.
    """
    # accelerations are discontinuous where contacts begin
    control = scene.control[0]
    ratio = h / clock.step if clock.step > 0.0 and clock.kinked == 0 else 0.0
    predict_stages(
        nodes, scene.stages, scene.A, scene.C, h, ratio if ratio < MAX_STEP_RATIO else 0.0
    )
    speed = reference_speed(clock)
    previous, converged = 1e300, False
    allowed = iteration_tolerance(h, clock, control, ORDER, ESTIMATE)
    for count in range(MAX_ITERATIONS):
        refactor = count == 0 and not reuses_factors
        evaluate_stages(h, refactor, closes_stages, clock, nodes, rows, saddle, scene)
        worst = correct_stages(h, speed, nodes, rows, scene)
        contraction = count_iteration(clock, count, worst, previous, LEAST_CONTRACTION)
        converged = has_converged(
            count, contraction, worst, previous, allowed, control, scene.stages, speed
        )
        if converged or diverges_early(count, worst, previous):
            break
        previous = worst
        # beams deform much within a step: tangents of a prediction are too inaccurate
        if ASSEMBLED and (contraction > 2.0 * LEAST_CONTRACTION or worst > 0.01):
            clock.factored = 0.0
    move_to_stage(nodes, scene.stages, STAGES - 1)
    if not converged:
        clock.fault = UNSOLVED
        return False
    if not JOINTS:
        return True
    return project(clock.time + h, closing_tolerance(control), clock, nodes, rows, saddle, scene)


@stage
def evaluate_stages(h, refactor, closes_stages, clock, nodes, rows, saddle, scene):
    """Rates of all stages at their present configurations; `refactor`: also their matrices.

    Writes: nodes, rows, scene.stages, new histories.
    """
    factors, tables = stage_factors(scene), stage_tables(scene)
    if ASSEMBLED:
        refactor = refactor or clock.factored == 0.0
    for i in range(1, STAGES):
        move_to_stage(nodes, scene.stages, i)
        set_stage_weights(h, i, clock, scene)
        time = scene.C[i] * h
        if JOINTS and closes_stages:
            close_stage(clock.time + time, clock, nodes, rows, saddle, scene)
        evaluate(clock.time + time, time, clock, nodes, rows, saddle, scene)
        store_rates(nodes, rows, scene.stages, i)
        store_spin_rates(nodes, scene.stages, i)
        if refactor:
            t = h * scene.T[(STAGES + 1) * i]
            tangents(clock, nodes, scene.curves, tables[i - 1], scene)
            if ASSEMBLED:
                assemble_stiffness(time, clock, nodes, scene.curves, factors[i - 1], scene)
            clock.factored = h
            linearise(rows, tables[i - 1], nodes, t, t * t)
            factor_compliant(factors[i - 1], tables[i - 1], rows.shape[0], t * t, t)


@kernel
def close_stage(time, clock, nodes, rows, saddle, scene):
    """Move the bodies to the nearest configuration and velocities that the joints allow.

    On those the rates are the same, and so is the order. Near a singular configuration, reactions
    magnify the open joints of a stage without bound, and the iteration would diverge.
    Writes: nodes, rows, saddle.
    """
    refresh(nodes)
    jacobian(clock.current, time, nodes, rows, scene.curves, scene)
    factor_constraints(rows, saddle, nodes)
    project(time, 0.0, clock, nodes, rows, saddle, scene)


@stage
def correct_stages(h, speed, nodes, rows, scene):
    """One stage after the other. Returns the largest correction. Writes: nodes, scene.stages."""
    factors, tables, worst = stage_factors(scene), stage_tables(scene), 0.0
    for i in range(1, STAGES):
        move_to_stage(nodes, scene.stages, i)
        stage_residual(nodes, scene.stages, scene.A, scene.T, i, h)
        t = h * scene.T[(STAGES + 1) * i]
        solve_stage(nodes, scene.stages, i, tables[i - 1], factors[i - 1], rows.shape[0], t)
        size = correction_size(nodes, scene.stages, i, scene.control[0].length, speed)
        if not size <= worst:
            worst = size
        correct_stage(nodes, scene.stages, i)
    return worst


@kernel
def stage_tables(scene):
    """The rows of springs and joints at each stage."""
    return (scene.compliant_0, scene.compliant_1, scene.compliant_2)


@kernel
def stage_factors(scene):
    """The factors of the stages' matrices."""
    updates = scene.compliant_updates
    if ASSEMBLED:
        slots = scene.compliant_slots
        return (
            Bordered(scene.columns_0, scene.blocks_0, updates, slots),
            Bordered(scene.columns_1, scene.blocks_1, updates, slots),
            Bordered(scene.columns_2, scene.blocks_2, updates, slots),
        )
    return (
        compliant_saddle(scene, scene.columns_0, scene.blocks_0),
        compliant_saddle(scene, scene.columns_1, scene.blocks_1),
        compliant_saddle(scene, scene.columns_2, scene.blocks_2),
    )


@stage
def evaluate_end(h, clock, nodes, rows, saddle, scene):
    """Rates of the last stage, at the end of the step. Writes: nodes, histories, scene.stages."""
    clock.opens, clock.closes, clock.ends = 0, 1, 1
    clock.share = h * scene.A[STAGES * STAGES - 1]
    evaluate(clock.time + h, h, clock, nodes, rows, saddle, scene)
    store_rates(nodes, rows, scene.stages, STAGES - 1)
    store_spin_rates(nodes, scene.stages, STAGES - 1)
    if CONTACTS:
        begin_contacts(clock.time + h, clock, nodes, rows, saddle, scene)


@kernel
def estimate(h, clock, nodes, scene, size, speed):
    """Estimated error of the step; stiff components are damped as by the method.

    Writes: scene.stages.right_* of the last stage.
    """
    last = STAGES - 1
    embedded_difference(nodes, scene.stages, scene.E, last, h)
    t = h * scene.T[(STAGES + 1) * last]
    factor, table = stage_factors(scene)[last - 1], stage_tables(scene)[last - 1]
    solve_stage(nodes, scene.stages, last, table, factor, scene.rows.shape[0], t)
    return correction_size(nodes, scene.stages, last, size, speed)


@stage
def set_stage_weights(h, i, clock, scene):
    """Set the weights of stage i in sums over the step. Writes: clock."""
    end = STAGES * (STAGES - 1)
    clock.opens = 1 if i == 1 else 0
    clock.closes = 0
    clock.ends = 1 if i == STAGES - 1 else 0
    clock.lead = 0.0
    # the last stage counts when the step has arrived
    clock.share = h * scene.A[end + i] if i < STAGES - 1 else 0.0
