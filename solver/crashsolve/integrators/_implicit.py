"""Step of an implicit method for stiff springs and constrained bodies, its length by its own error.

    stages of the method, by iteration, then positions onto Phi = 0 and velocities onto D v = nu

A step whose estimated error is above `tolerance`, or whose iteration does not converge, is tried
again shorter; one in which a contact or a branch of a law begins ends there. This file is the
stepper of all methods of this kind, with the stages of the deck's.

Reference: Hairer and Wanner (1996), Solving Ordinary Differential Equations II, IV.8.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.integrators._collocation import (
    CAN_CLOSE_STAGES,
    estimate,
    evaluate_end,
    open_step,
    solve_stages,
)
from crashsolve.integrators._positions import accept, begin, begin_at_event, evaluate, onset_gap
from crashsolve.integrators.radau_iia_5 import ESTIMATE, STAGES
from crashsolve.model.clock import (
    RUNNING,
    STEP_TOO_SMALL,
)
from crashsolve.system.implicit.stages import (
    add_external,
    add_kick,
    fastest_so_far,
    next_length,
    reference_speed,
)
from crashsolve.system.kinetics import accelerations, refresh, save
from crashsolve.system.loops.events import approach_before, event, may_pass
from crashsolve.system.loops.joints import residual
from crashsolve.system.loops.sensors import measure
from crashsolve.system.onset import first_gap, narrow_bracket, new_bracket
from crashsolve.system.placeholders import BOUNDS_NEXT_STEP, CONTACTS, EVENTS, JOINTS, ONSETS
from crashsolve.system.timestep import fit

MANY_ITERATIONS = 8  # iterations of a step, after which the next is no longer
# the factors of a step are used again in the next, of nearly the same length, after few iterations
FEW_ITERATIONS, CLOSE_STEPS = 4, 0.02
ATTEMPTS = 300  # of one step; more are taken for an endless loop
ONSET = 1e-4  # of the displacement in the step, by which an onset may be passed


@stage
def prepare_sample(until, clock, nodes, rows, saddle, scene):
    """Forces, reactions and readings of a sample; returns its time [s].

    Writes: nodes, rows, outputs, new histories, clock.
    """
    if JOINTS:
        residual(clock.current, clock.time, nodes, rows, scene.curves, scene)
    refresh(nodes)
    clock.lead = clock.share = 0.0
    clock.opens = clock.closes = 1
    evaluate(clock.time, 0.0, clock, nodes, rows, saddle, scene)
    accelerations(nodes)
    measure(clock.time, nodes, rows, scene.curves, scene)
    if clock.next_step <= 0.0:
        begin(clock, scene.control[0], nodes)
    return clock.time


@stage
def take_step(until, clock, nodes, rows, saddle, scene):
    """A step; returns the time at its end and its length [s]. Writes: nodes, rows, histories."""
    h, is_last = fit(clock.next_step, until - clock.time)
    save(nodes)
    open_step(clock, nodes, rows, scene)
    taken = find_step(h, clock, nodes, rows, saddle, scene)
    if clock.status == RUNNING:
        add_external(clock, scene.stages, scene.A, STAGES - 1, taken)
        add_kick(clock, 1.0)
    return (until if is_last and taken == h else clock.time + taken), taken


@stage
def finish(time, h, sampling, clock, nodes, rows, saddle, scene):
    """The new state becomes the present one. Writes: clock."""
    accept(time, h, clock, scene.control[0])


@stage
def find_step(h, clock, nodes, rows, saddle, scene):
    """One step of at most h that is accurate and ends where a contact or a branch of a law begins.

    Returns the step taken. Writes: nodes, rows, scene.stages, new histories, clock.next_step.
    """
    control = scene.control[0]
    bracket, trial, is_located, before = new_bracket(h), h, False, 0.0
    if ONSETS:
        before = gap_before(clock, nodes, scene)
    attempts, closes_stages = 0, False
    while True:
        attempts += 1
        if attempts > ATTEMPTS:
            clock.status = STEP_TOO_SMALL
            break
        reuses, fault = can_reuse_factors(trial, clock), STEP_TOO_SMALL
        if not solve_stages(trial, reuses, closes_stages, clock, nodes, rows, saddle, scene):
            clock.factored = 0.0
            # the factors may be the cause of the failure
            if reuses:
                continue
            # or joints that are open at a stage near a singular configuration
            if JOINTS and CAN_CLOSE_STAGES and not closes_stages:
                closes_stages = True
                continue
            # too long for the iteration or the joints: as if the error were large
            closes_stages, fault = False, clock.fault
            proposed = 0.25 * trial
        elif BOUNDS_NEXT_STEP and may_pass(bracket[-1], trial, clock, nodes, scene):
            proposed = max(0.5 * trial, control.step_min)
        else:
            if ONSETS:
                gap = onset_gap(trial, clock, nodes, scene)
                if bracket[-1] == 0:
                    bracket = first_gap(bracket, before, gap, control, ONSET)
                bracket, trial, is_located = narrow_bracket(bracket, h, trial, gap)
                if not is_located:
                    continue
            # beyond the end of a curve during an iteration is no fault
            scene.curves[0].fault = 0
            evaluate_end(trial, clock, nodes, rows, saddle, scene)
            proposed = check_error(trial, clock, nodes, scene)
            if proposed == 0.0:
                break
        clock.rejected += 1
        h = trial = clock.next_step = proposed
        bracket = new_bracket(h)
        if h < control.step_min:
            clock.status = fault
            break
    # something began at the end, searched for or met by chance
    clock.kinked = 1 if bracket[-1] > 0 or bracket[3] > 0.0 else 0
    if clock.kinked == 1:
        begin_at_event(clock, control, nodes)
        clock.factored = 0.0
    return trial


@kernel
def can_reuse_factors(h, clock):
    """Whether the factors of an earlier step can be used in a step of h."""
    return clock.last_iterations <= FEW_ITERATIONS and abs(h - clock.factored) <= CLOSE_STEPS * h


@kernel
def gap_before(clock, nodes, scene):
    """Largest depth of the events that may begin, at the start of the step [m or rad]."""
    gap = -1e300
    if CONTACTS:
        gap = approach_before(clock, scene)
    if EVENTS:
        gap = max(gap, event(clock.current, 0.0, nodes, scene.curves, scene))
    return min(gap, 0.0)


@stage
def check_error(h, clock, nodes, scene):
    """0 where the step is accurate, else the length to try. Writes: clock.next_step, fastest."""
    control = scene.control[0]
    speed = reference_speed(clock)
    error = estimate(h, clock, nodes, scene, control.length, speed)
    if control.fixed_step > 0.0:
        # the length of the step is prescribed, but its equations are solved to a share of its
        # error; that of a step that begins or ends at a kink is unknown
        clock.error = error if clock.kinked == 0 else 0.0
        return 0.0
    proposed = next_length(h, error, clock, control.tolerance, ESTIMATE)
    if not error <= control.tolerance:
        return proposed
    # of accepted steps only: velocities of a rejected one may be far off
    clock.fastest = fastest_so_far(clock, control, nodes)
    clock.error = error
    # the error of a step cut short by a sample predicts little of a longer one
    if h < clock.next_step:
        proposed = max(proposed, clock.next_step)
    # the iteration hardly converged
    if clock.last_iterations > MANY_ITERATIONS:
        proposed = min(proposed, h)
    clock.next_step = min(proposed, control.step_max, control.curve_step)
    return 0.0
