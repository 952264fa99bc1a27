"""Explicit Runge-Kutta step for constrained rigid bodies, its length chosen by its own error.

    k_i = rates at the position to which sum_j a_ij k_j leads, with the reactions of that position
    end of step: sum_j b_j k_j, then positions onto Phi = 0 and velocities onto D v = nu,
    both by the least change that the inertia allows (D^T along M^-1)

A step whose estimated error is above `tolerance` is tried again shorter; one that would penetrate a
new contact is cut at the onset. This file is the stepper of all methods of this kind; the
tableau is that of the deck's `integrator`.

References: Hairer, Norsett and Wanner (1993), Solving Ordinary Differential Equations I, II.4;
Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482 (coordinate projection).
"""

from math import sqrt

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.integrators._positions import (
    accept,
    begin,
    begin_at_event,
    begin_contacts,
    closing_tolerance,
    evaluate,
    onset_gap,
    project,
    solve_reactions,
)
from crashsolve.integrators.dormand_prince_5 import ESTIMATES, EXTRA, ORDER, STAGES, TERMS
from crashsolve.model.clock import (
    RUNNING,
    STEP_TOO_SMALL,
)
from crashsolve.system.attachments import set_accelerations
from crashsolve.system.constraints import (
    factor_constraints,
)
from crashsolve.system.implicit.stages import (
    add_external,
    add_kick,
    advance_to_stage,
    estimate,
    fastest_so_far,
    next_length,
    project_estimate,
    reference_speed,
    set_dense_weights,
    step_error,
    store_rates,
)
from crashsolve.system.kinetics import (
    accelerations,
    apply_deferred,
    clear_forces,
    refresh,
    save,
)
from crashsolve.system.loops.energy import sum_powers
from crashsolve.system.loops.events import approach_before, event, may_pass
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import jacobian, residual
from crashsolve.system.loops.sensors import measure
from crashsolve.system.onset import first_gap, narrow_bracket, new_bracket
from crashsolve.system.placeholders import (
    ATTACHMENTS,
    BOUNDS_NEXT_STEP,
    CONTACTS,
    DENSE,
    EVENTS,
    JOINTS,
    ONSETS,
)
from crashsolve.system.timestep import fit, wanted_step

ONSET = 1e-4  # of the displacement in the step: by so much an onset may be passed at most
LOCATIONS = 10  # trials by dense output, before bisection
ATTEMPTS = 300  # of one step; more are taken for an endless loop
SAMPLE = STAGES + EXTRA  # as a stage: the position within a step where a sample is


@stage
def prepare_sample(until, clock, nodes, rows, saddle, scene):
    """Forces, reactions and readings of a sample, within the last step where need be.

    Returns its time [s]. Writes: nodes, rows, outputs, new histories, clock.
    """
    time, part = clock.time, 0.0
    if DENSE and until < time:
        part = restore_at(until, clock, nodes, rows, saddle, scene)
        time = until
    elif JOINTS:
        residual(clock.current, time, nodes, rows, scene.curves, scene)
    refresh(nodes)
    set_stage_weights(0.0, 0, clock, scene)
    clock.opens = clock.closes = 1
    evaluate(time, part, clock, nodes, rows, saddle, scene)
    if DENSE and part > 0.0:
        sum_powers(clock.current, clock.step, scene)
    accelerations(nodes)
    if ATTACHMENTS:
        set_accelerations(scene.attached_nodes, nodes)
    measure(time, nodes, rows, scene.curves, scene)
    if clock.next_step <= 0.0:
        begin(clock, scene.control[0], nodes)
    return time


@stage
def take_step(until, clock, nodes, rows, saddle, scene):
    """A step; returns the time at its end and its length [s]. Writes: nodes, rows, histories."""
    h, is_last = fit(clock.next_step, clock.goal - clock.time)
    save(nodes)
    store_rates(nodes, rows, scene.stages, 0)
    taken = find_step(h, clock, nodes, rows, saddle, scene)
    if clock.status == RUNNING:
        add_external(clock, scene.stages, scene.A, STAGES - 1, taken)
        add_kick(clock, 1.0)
    return (clock.goal if is_last and taken == h else clock.time + taken), taken


@stage
def finish(time, h, sampling, clock, nodes, rows, saddle, scene):
    """The new state becomes the present one. Writes: clock."""
    accept(time, h, clock, scene.control[0])


@stage
def restore_at(time, clock, nodes, rows, saddle, scene):
    """Move the copies to a time within the last step by dense output, including sums over the step.

    Returns the time since the start of the step [s]. Writes: clock, nodes, rows, scene.stages, A.
    """
    h = clock.step
    start_time = clock.time - h
    # histories count from the start of the step
    clock.current = 1 - clock.current
    evaluate_extra_stages(start_time, h, clock, nodes, rows, saddle, scene)
    set_dense_weights(scene.A, scene.D, TERMS, STAGES - 1, SAMPLE, (time - start_time) / h)
    advance_to_stage(nodes, scene.stages, scene.A, SAMPLE, h)
    add_external(clock, scene.stages, scene.A, STAGES - 1, -h)
    add_external(clock, scene.stages, scene.A, SAMPLE, h)
    add_kick(clock, -1.0)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, scene.curves, scene)
        refresh(nodes)
        factor_constraints(rows, saddle, nodes)
        if not project(
            time, closing_tolerance(scene.control[0]), clock, nodes, rows, saddle, scene
        ):
            clock.status = clock.fault
        add_kick(clock, 1.0)
    return time - start_time


@kernel
def evaluate_extra_stages(start_time, h, clock, nodes, rows, saddle, scene):
    """Stages that only the dense output needs. Writes: nodes, rows, scene.stages, new histories."""
    for i in range(STAGES, SAMPLE):
        advance_to_stage(nodes, scene.stages, scene.A, i, h)
        refresh(nodes)
        set_stage_weights(0.0, i, clock, scene)
        after = scene.C[i] * h
        evaluate(start_time + after, after, clock, nodes, rows, saddle, scene)
        store_rates(nodes, rows, scene.stages, i)


@stage
def find_step(h, clock, nodes, rows, saddle, scene):
    """One step of at most h that is accurate and ends no deeper than `allowed` in a new contact.

    Returns the step taken. Writes: nodes, rows, scene.stages, new histories, clock.next_step.
    """
    search, attempts = new_search(h), 0
    while True:
        attempts += 1
        if attempts > ATTEMPTS:
            clock.status = STEP_TOO_SMALL
            break
        # beyond the end of a curve in an attempt that was too long is no fault
        scene.curves[0].fault = 0
        closed = evaluate_stages(h, clock, nodes, rows, saddle, scene)
        if BOUNDS_NEXT_STEP and closed and may_pass(search[-1], h, clock, nodes, scene):
            clock.rejected += 1
            h = clock.next_step = 0.5 * h
            search = new_search(h)
            continue
        if closed and ONSETS:
            end, search = cut_at_onset(h, search, clock, nodes, rows, saddle, scene)
            if end != h:
                h = end
                continue
        # too long for the joints: as if the error were large
        proposed = 0.25 * h
        if closed:
            evaluate_end(h, clock, nodes, rows, saddle, scene)
            proposed = check_error(h, clock, nodes, rows, saddle, scene)
        if proposed == 0.0:
            break
        clock.rejected += 1
        h = clock.next_step = proposed
        search = new_search(h)
        if h < scene.control[0].step_min:
            clock.status = STEP_TOO_SMALL if closed else clock.fault
            break
    if search[-1] > 0:
        begin_at_event(clock, scene.control[0], nodes)
    return h


@kernel
def new_search(h):
    """Early and late end of a step in which something begins, gap before, allowed gap, tries."""
    return 0.0, h, 0.0, 0.0, 0


@stage
def cut_at_onset(h, search, clock, nodes, rows, saddle, scene):
    """The step to try next, that ends where something begins; h itself when it does so already.

    Where it begins is located by the dense output of a step that went beyond; the shorter that
    step, the better. Returns the step and the search. Writes: nodes, scene.*.
    """
    early, late, before, allowed, tries = search
    gap = onset_gap(h, clock, nodes, scene)
    is_narrow = late - early <= 1e-13 * clock.next_step
    if (tries == 0 and gap <= 0.0) or (tries > 0 and gap > 0.0 and (gap <= allowed or is_narrow)):
        return h, search
    if gap > 0.0:
        late = h
        h, before, allowed = locate_event(h, gap, clock, nodes, rows, saddle, scene)
    else:
        early = h
        # twice as far as the gap says: the dense output of that step serves
        h += (allowed - 2.0 * gap) * h / (gap - before)
    if tries >= LOCATIONS or not early < h < late:
        h = late if is_narrow else 0.5 * (early + late)
    return h, (early, late, before, allowed, tries + 1)


@stage
def locate_event(h, gap, clock, nodes, rows, saddle, scene):
    """Locate the first event in the step just tried, by its dense output.

    Returns the step that ends there, and by how much it may be passed. Writes: nodes, scene.*.
    """
    control = scene.control[0]
    evaluate_end(h, clock, nodes, rows, saddle, scene)
    evaluate_extra_stages(clock.time, h, clock, nodes, rows, saddle, scene)
    before = gap_before(h, clock, nodes, scene)
    # the error of an onset passed by x grows with the square of x
    share = min(ONSET, sqrt(control.tolerance))
    bracket = first_gap(new_bracket(h), before, gap, control, share)
    bracket, trial, is_located = narrow_bracket(bracket, h, h, gap)
    while not is_located:
        set_dense_weights(scene.A, scene.D, TERMS, STAGES - 1, SAMPLE, trial / h)
        advance_to_stage(nodes, scene.stages, scene.A, SAMPLE, h)
        refresh(nodes)
        past = onset_gap(trial, clock, nodes, scene)
        bracket, trial, is_located = narrow_bracket(bracket, h, trial, past)
    return trial, before, bracket[4]


@stage
def gap_before(h, clock, nodes, scene):
    """The smallest gap at the start of the step.

    Writes: nodes, which the next trial moves again.
    """
    gap = -1e300
    if CONTACTS:
        gap = approach_before(clock, scene)
    if EVENTS:
        advance_to_stage(nodes, scene.stages, scene.A, 0, h)
        refresh(nodes)
        gap = max(gap, event(clock.current, h, nodes, scene.curves, scene))
    return min(gap, 0.0)


@kernel
def evaluate_end(h, clock, nodes, rows, saddle, scene):
    """Rates of the last stage, at the end of the step. Writes: nodes, histories, scene.stages."""
    set_stage_weights(h, STAGES - 1, clock, scene)
    clear_forces(nodes)
    force_pass(clock, clock.time + h, h, nodes, rows, scene.curves, scene)
    # a force that begins at the end of the step is no error of the step
    if CONTACTS:
        apply_deferred(nodes, -1.0)
    if JOINTS:
        # D and its factor are those of the projection
        solve_reactions(clock.time + h, clock, nodes, rows, saddle, scene)
    store_rates(nodes, rows, scene.stages, STAGES - 1)
    if CONTACTS:
        begin_contacts(clock.time + h, clock, nodes, rows, saddle, scene)


@stage
def check_error(h, clock, nodes, rows, saddle, scene):
    """0 where the step is accurate, else the length to try. Writes: clock.next_step, fastest."""
    control = scene.control[0]
    if control.fixed_step > 0.0:
        return 0.0
    speed = reference_speed(clock)
    for k in range(ESTIMATES):
        estimate(nodes, scene.stages, STAGES, scene.E, scene.errors, k, h)
        if JOINTS:
            project_estimate(scene.errors, k, nodes, rows, saddle)
    error = step_error(scene.errors, control.length, speed)
    proposed = next_length(h, error, clock, control.tolerance, ORDER)
    if not error <= control.tolerance:
        return proposed
    # of accepted steps only: velocities of a rejected one may be far off
    clock.fastest = fastest_so_far(clock, control, nodes)
    clock.error = error
    # a step cut short predicts little of a longer one
    if h < 0.5 * clock.next_step:
        proposed = max(proposed, clock.next_step)
    clock.next_step = min(proposed, control.step_max, control.curve_step)
    if control.resolves == 1:
        clock.next_step = min(clock.next_step, wanted_step(clock, control, nodes))
        clock.limit_node = 0
    return 0.0


@stage
def evaluate_stages(h, clock, nodes, rows, saddle, scene):
    """All stages but the rates of the last. Returns whether the joints could be closed at the end.

    Writes: nodes, rows, scene.stages, new histories.
    """
    for i in range(1, STAGES):
        advance_to_stage(nodes, scene.stages, scene.A, i, h)
        refresh(nodes)
        if i < STAGES - 1:
            set_stage_weights(h, i, clock, scene)
            evaluate(
                clock.time + scene.C[i] * h,
                scene.C[i] * h,
                clock,
                nodes,
                rows,
                saddle,
                scene,
            )
            store_rates(nodes, rows, scene.stages, i)
    if not JOINTS:
        return True
    return project(
        clock.time + h, closing_tolerance(scene.control[0]), clock, nodes, rows, saddle, scene
    )


@kernel
def set_stage_weights(h, i, clock, scene):
    """Set the weights of stage i in sums over the step. Writes: clock."""
    end = (SAMPLE + 1) * (STAGES - 1)
    clock.stage = i
    clock.opens = 1 if i == 1 else 0
    clock.closes = 1 if i == STAGES - 1 else 0
    # 1 but for round-off
    clock.ends = 1 if scene.C[i] > 1.0 - 1e-9 else 0
    clock.lead = h * scene.A[end]
    clock.share = h * scene.A[end + i]
