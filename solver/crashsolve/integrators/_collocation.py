"""Stages of an implicit Runge-Kutta step: stages of the stepper `_implicit`.

    k_i = rates at the position to which sum_j a_ij k_j leads, with the reactions of that position,
    for all stages at once, by iteration with the tangents of springs and contacts

The end of the step is its last stage. Consequence to test: the step of a stiff deck is that of its
motion, whatever the stiffness.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.foundation.sparse.bordered import Bordered
from crashsolve.foundation.sparse.saddle import compliant_saddle
from crashsolve.integrators._positions import begin_contacts, evaluate, project
from crashsolve.integrators.radau_iia_5 import ESTIMATE, ORDER, STAGES
from crashsolve.model.clock import UNSOLVED
from crashsolve.system.implicit.collocation import (
    correction_size,
    guess,
    improve,
    keep_past,
    keep_spin_rates,
    miss,
    stand,
    weigh_estimate,
)
from crashsolve.system.implicit.compliance import factor_compliant, linearise, solve_stage
from crashsolve.system.implicit.iteration import (
    PASSES,
    diverges_early,
    enough_beside,
    is_near,
    note_pass,
)
from crashsolve.system.implicit.stages import keep_rates, reference_speed
from crashsolve.system.loops.elements import keep_elements
from crashsolve.system.loops.tangents import bend, tangents
from crashsolve.system.placeholders import ASSEMBLED, CONTACTS, JOINTS

# a step longer than so many of the last is not guessed from it
FAR = 4.0
# the least share of the error that a pass leaves, where the problem is stiff
SHARE = 0.3


@stage
def open_step(clock, nodes, rows, scene):
    """Rates at the start of the step. Writes: scene.stages."""
    keep_rates(nodes, rows, scene.stages, 0)
    keep_spin_rates(nodes, scene.stages, 0)
    keep_past(scene.stages)
    if ASSEMBLED:
        keep_elements(scene)


@stage
def pass_stages(h, kept, clock, nodes, rows, saddle, scene):
    """All stages, by iteration. Returns whether they converge and the joints can be closed.

    `kept`: with the factors at hand.

    Writes: nodes, rows, scene.stages, new histories.
    """
    # accelerations jump with contacts
    control = scene.control[0]
    ratio = h / clock.step if clock.step > 0.0 and clock.kinked == 0 else 0.0
    guess(nodes, scene.stages, scene.A, scene.C, h, ratio if ratio < FAR else 0.0)
    speed = reference_speed(clock)
    previous, converged = 1e300, False
    enough = enough_beside(h, clock, control, ORDER, ESTIMATE)
    for count in range(PASSES):
        visit_stages(h, count == 0 and not kept, clock, nodes, rows, saddle, scene)
        worst = correct_stages(h, speed, nodes, rows, scene)
        share = note_pass(clock, count, worst, previous, SHARE)
        converged = is_near(count, share, worst, previous, enough, control, scene.stages, speed)
        if converged or diverges_early(count, worst, previous):
            break
        previous = worst
        # beams bend far within a step: tangents of a guess do not serve
        if ASSEMBLED and (share > 2.0 * SHARE or worst > 0.01):
            clock.factored = 0.0
    stand(nodes, scene.stages, STAGES - 1)
    if not converged:
        clock.fault = UNSOLVED
        return False
    if not JOINTS:
        return True
    return project(clock.time + h, clock, nodes, rows, saddle, scene)


@stage
def visit_stages(h, anew, clock, nodes, rows, saddle, scene):
    """Rates of all stages where they are at present; `anew`: also their matrices.

    Writes: nodes, rows, scene.stages, new histories.
    """
    factors, tables = stage_factors(scene), stage_tables(scene)
    if ASSEMBLED:
        anew = anew or clock.factored == 0.0
    for i in range(1, STAGES):
        stand(nodes, scene.stages, i)
        weigh_pass(h, i, clock, scene)
        time = scene.C[i] * h
        evaluate(clock.time + time, time, clock, nodes, rows, saddle, scene)
        keep_rates(nodes, rows, scene.stages, i)
        keep_spin_rates(nodes, scene.stages, i)
        if anew:
            t = h * scene.T[(STAGES + 1) * i]
            tangents(clock, nodes, scene.curves, tables[i - 1], scene)
            if ASSEMBLED:
                bend(time, clock, nodes, scene.curves, factors[i - 1], scene)
            clock.factored = h
            linearise(rows, tables[i - 1], nodes, t, t * t)
            factor_compliant(factors[i - 1], tables[i - 1], rows.shape[0], t * t, t)


@stage
def correct_stages(h, speed, nodes, rows, scene):
    """One stage after the other. Returns the largest correction. Writes: nodes, scene.stages."""
    factors, tables, worst = stage_factors(scene), stage_tables(scene), 0.0
    for i in range(1, STAGES):
        stand(nodes, scene.stages, i)
        miss(nodes, scene.stages, scene.A, scene.T, i, h)
        t = h * scene.T[(STAGES + 1) * i]
        solve_stage(nodes, scene.stages, i, tables[i - 1], factors[i - 1], rows.shape[0], t)
        size = correction_size(nodes, scene.stages, i, scene.control[0].length, speed)
        if not size <= worst:
            worst = size
        improve(nodes, scene.stages, i)
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
def arrive(h, clock, nodes, rows, saddle, scene):
    """Rates of the last stage, at the end of the step. Writes: nodes, histories, scene.stages."""
    clock.opens, clock.closes, clock.ends = 0, 1, 1
    clock.share = h * scene.A[STAGES * STAGES - 1]
    evaluate(clock.time + h, h, clock, nodes, rows, saddle, scene)
    keep_rates(nodes, rows, scene.stages, STAGES - 1)
    keep_spin_rates(nodes, scene.stages, STAGES - 1)
    if CONTACTS:
        begin_contacts(clock.time + h, clock, nodes, rows, saddle, scene)


@kernel
def estimate(h, clock, nodes, scene, size, speed):
    """Estimated error of the step; stiff components are damped as by the method.

    Writes: scene.stages.right_* of the last stage.
    """
    last = STAGES - 1
    weigh_estimate(nodes, scene.stages, scene.E, last, h)
    t = h * scene.T[(STAGES + 1) * last]
    factor, table = stage_factors(scene)[last - 1], stage_tables(scene)[last - 1]
    solve_stage(nodes, scene.stages, last, table, factor, scene.rows.shape[0], t)
    return correction_size(nodes, scene.stages, last, size, speed)


@stage
def weigh_pass(h, i, clock, scene):
    """Set the weights of stage i in sums over the step. Writes: clock."""
    end = STAGES * (STAGES - 1)
    clock.opens = 1 if i == 1 else 0
    clock.closes = 0
    clock.ends = 1 if i == STAGES - 1 else 0
    clock.lead = 0.0
    # the last stage counts when the step has arrived
    clock.share = h * scene.A[end + i] if i < STAGES - 1 else 0.0
