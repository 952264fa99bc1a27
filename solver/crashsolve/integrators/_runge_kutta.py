"""Explicit Runge-Kutta step for constrained rigid bodies, its length chosen by its own error.

    k_i = rates at the place to which sum_j a_ij k_j leads, with the reactions of that place
    end of step: sum_j b_j k_j, then positions onto Phi = 0 and velocities onto D v = nu,
    both by the least change that the inertia allows (D^T along M^-1)

A step whose estimated error is above `accuracy` is tried again shorter; one that would penetrate a
new contact is cut at the onset. This file is the recital of all methods of this kind; the tableau
is that of the deck's `integrator`.

References: Hairer, Norsett and Wanner (1993), Solving Ordinary Differential Equations I, II.4;
Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482 (coordinate projection).
"""

from math import sqrt

from crashsolve.foundation.compile import entry, kernel, stage  # noqa: F401  (the scene uses kernel)
from crashsolve.foundation.saddle import Saddle, solve_rows
from crashsolve.integrators.dormand_prince_5 import ESTIMATES, EXTRA, ORDER, STAGES, TERMS
from crashsolve.model.clock import (
    CURVE_END,
    POSITION,
    REACHED,
    REBUILD,
    RUNNING,
    STEP_TOO_SMALL,
)
from crashsolve.system.constraints import (
    acceleration_right_side,
    clear_joint_forces,
    clear_reaction,
    factor_constraints,
    kick_by_joints,
    scatter_delta,
    velocity_residual,
    worst_rate,
    worst_residual,
)
from crashsolve.system.energy import check
from crashsolve.system.kinetics import (
    accelerations,
    clear_forces,
    refresh,
    save,
    take_late,
)
from crashsolve.system.onset import first_gap, open_bracket, seek
from crashsolve.system.scene import (
    CONTACTS,
    DENSE,
    JOINTS,
    ONSETS,
    PIECES,
    REBUILDS,
    approach,
    approach_before,
    beyond,
    convective,
    energy,
    force_pass,
    jacobian,
    measure,
    need_rebuild,
    residual,
    sum_powers,
)
from crashsolve.system.stages import (
    add_outside,
    displace_by_joints,
    estimate,
    fastest_point,
    keep_rates,
    next_length,
    project_estimate,
    reach,
    spin_round_off,
    step_error,
    typical_speed,
    weigh_part,
)
from crashsolve.system.timestep import fit, wanted_step

PROJECTIONS = 10
ONSET = 1e-4  # of the way in the step: by so much what begins may be passed at most
LOCATIONS = 10  # tries of the dense output, before bisection
REFINEMENTS = 3
SAMPLE = STAGES + EXTRA  # as a stage: the place within a step where a sample is
ROUND_OFF = 1e-12  # of an acceleration or of the size: less than this is nothing


@entry
def advance(until, sampling, scene):
    """Step from the present time to exactly `until` [s], or to trouble. Writes: all of the State.

    A sample is a step of no length, taken on copies: outputs, reactions, accelerations, energies.
    """
    clock, control, ledger = scene.clock[0], scene.control[0], scene.ledger
    nodes, rows, curves = scene.nodes, scene.rows, scene.curves
    saddle = Saddle(scene.columns, scene.blocks, scene.updates, scene.pairs)
    clock.status = RUNNING
    while clock.status == RUNNING and (sampling or clock.time < until):
        time = clock.time
        if sampling:
            part = 0.0
            if DENSE and until < time:
                part = go_back(until, clock, control, nodes, rows, saddle, curves, scene)
                time = until
            elif JOINTS:
                residual(clock.current, time, nodes, rows, curves, scene)
            refresh(nodes)
            weigh_pass(0.0, 0, clock, scene)
            clock.opens = clock.closes = 1
            evaluate(time, part, clock, nodes, rows, saddle, curves, scene)
            if DENSE and part > 0.0:
                sum_powers(clock.current, clock.step, scene)
            accelerations(nodes)
            measure(time, nodes, rows, curves, scene)
            if clock.next_step <= 0.0:
                begin(clock, control, nodes)
            h = 0.0
        else:
            if REBUILDS and need_rebuild(clock, nodes, scene):
                clock.status = REBUILD
                return
            h, is_last = fit(clock.next_step, clock.goal - clock.time)
            save(nodes)
            keep_rates(nodes, rows, scene.stages, 0)
            taken = take(h, clock, control, nodes, rows, saddle, curves, scene)
            time = clock.goal if is_last and taken == h else clock.time + taken
            h = taken
            if clock.status != RUNNING:
                return
            add_outside(clock, scene.stages, scene.A, STAGES - 1, h)
        accept(time, h, clock, control)
        if sampling or clock.cycle % control.check_every == 0:
            energy(clock, nodes, scene, ledger)
            check(clock, control, nodes, ledger)
        if sampling:
            return
        if curves[0].fault > 0:
            clock.status = CURVE_END
    if clock.status == RUNNING:
        clock.status = REACHED


@stage
def go_back(time, clock, control, nodes, rows, saddle, curves, scene):
    """Copies to a time within the last step, by dense output; what is summed as well.

    Returns the time since the start of the step [s]. Writes: clock, nodes, rows, scene.stages, A.
    """
    h = clock.step
    begun = clock.time - h
    # histories count from the start of the step
    clock.current = 1 - clock.current
    pass_extra_stages(begun, h, clock, nodes, rows, saddle, curves, scene)
    weigh_part(scene.A, scene.D, TERMS, STAGES - 1, SAMPLE, (time - begun) / h)
    reach(nodes, scene.stages, scene.A, SAMPLE, h)
    add_outside(clock, scene.stages, scene.A, STAGES - 1, -h)
    add_outside(clock, scene.stages, scene.A, SAMPLE, h)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, curves, scene)
        refresh(nodes)
        factor_constraints(rows, saddle, nodes)
        if not project(time, clock, control, nodes, rows, saddle, curves, scene):
            clock.status = POSITION
    return time - begun


@kernel
def pass_extra_stages(begun, h, clock, nodes, rows, saddle, curves, scene):
    """Stages that only the dense output needs. Writes: nodes, rows, scene.stages, new histories."""
    for i in range(STAGES, SAMPLE):
        reach(nodes, scene.stages, scene.A, i, h)
        refresh(nodes)
        weigh_pass(0.0, i, clock, scene)
        after = scene.C[i] * h
        evaluate(begun + after, after, clock, nodes, rows, saddle, curves, scene)
        keep_rates(nodes, rows, scene.stages, i)


@stage
def begin(clock, control, nodes):
    """A first guess of the step, and the speed that errors are compared to. Writes: clock."""
    clock.fastest = typical_speed(nodes, control.length)
    clock.next_step = wanted_step(clock, control, nodes)
    clock.limit_node = 0
    if clock.fastest > 0.0:
        clock.next_step = min(clock.next_step, 0.01 * control.length / clock.fastest)


@stage
def take(h, clock, control, nodes, rows, saddle, curves, scene):
    """One step of at most h that is accurate and ends no deeper than `allowed` in a new contact.

    Returns the step taken. Writes: nodes, rows, scene.stages, new histories, clock.next_step.
    """
    search = open_search(h)
    while True:
        closed = pass_stages(h, clock, control, nodes, rows, saddle, curves, scene)
        if closed and ONSETS:
            end, search = cut(h, search, clock, control, nodes, rows, saddle, curves, scene)
            if end != h:
                h = end
                continue
        # too long for the joints: as if the error were large
        wanted = 0.25 * h
        if closed:
            arrive(h, clock, nodes, rows, saddle, curves, scene)
            wanted = judge(h, clock, control, nodes, rows, saddle, scene)
        if wanted == 0.0:
            break
        clock.rejected += 1
        h = clock.next_step = wanted
        search = open_search(h)
        if h < control.step_min:
            clock.status = STEP_TOO_SMALL if closed else POSITION
            break
    clock.located += 1 if search[-1] > 0 else 0
    return h


@kernel
def open_search(h):
    """Early and late end of a step in which something begins, gap before, allowed gap, tries."""
    return 0.0, h, 0.0, 0.0, 0


@stage
def cut(h, search, clock, control, nodes, rows, saddle, curves, scene):
    """The step to try next, that ends where something begins; h itself when it does so already.

    Where is told by the dense output of a step that went too far; the shorter that is, the better.
    Returns the step and the search. Writes: nodes, scene.*.
    """
    early, late, before, allowed, tries = search
    gap = onset_gap(h, clock, control, nodes, curves, scene)
    is_narrow = late - early <= 1e-13 * clock.next_step
    if (tries == 0 and gap <= 0.0) or (tries > 0 and gap > 0.0 and (gap <= allowed or is_narrow)):
        return h, search
    if gap > 0.0:
        late = h
        h, before, allowed = locate(h, gap, clock, control, nodes, rows, saddle, curves, scene)
    else:
        early = h
        # twice as far as the gap says: the dense output of that step serves
        h += (allowed - 2.0 * gap) * h / (gap - before)
    if tries >= LOCATIONS or not early < h < late:
        h = late if is_narrow else 0.5 * (early + late)
    return h, (early, late, before, allowed, tries + 1)


@stage
def locate(h, gap, clock, control, nodes, rows, saddle, curves, scene):
    """Where in the step just tried something begins, by its dense output.

    Returns the step that ends there, and by how much it may be passed. Writes: nodes, scene.*.
    """
    arrive(h, clock, nodes, rows, saddle, curves, scene)
    pass_extra_stages(clock.time, h, clock, nodes, rows, saddle, curves, scene)
    before = gap_before(h, clock, nodes, curves, scene)
    # what is passed errs by its square
    share = min(ONSET, sqrt(control.accuracy))
    bracket = first_gap(open_bracket(h), before, gap, control.onset_tolerance, share)
    bracket, trial, found = seek(bracket, h, h, gap)
    while not found:
        weigh_part(scene.A, scene.D, TERMS, STAGES - 1, SAMPLE, trial / h)
        reach(nodes, scene.stages, scene.A, SAMPLE, h)
        refresh(nodes)
        past = onset_gap(trial, clock, control, nodes, curves, scene)
        bracket, trial, found = seek(bracket, h, trial, past)
    return trial, before, bracket[4]


@kernel
def onset_gap(h, clock, control, nodes, curves, scene):
    """Largest depth of what begins in a step of h: a contact, its end, or a piece of a law."""
    gap = -1e300
    if CONTACTS:
        gap = approach(clock.current, nodes, scene)
    if PIECES:
        # what rests at a corner passes it by round-off again and again
        past = beyond(clock.current, h, nodes, curves, scene) - ROUND_OFF * control.length
        gap = max(gap, past)
    return gap


@stage
def gap_before(h, clock, nodes, curves, scene):
    """The same at the start of the step. Writes: nodes, which the next trial moves again."""
    gap = -1e300
    if CONTACTS:
        gap = approach_before(clock.current, scene)
    if PIECES:
        reach(nodes, scene.stages, scene.A, 0, h)
        refresh(nodes)
        gap = max(gap, beyond(clock.current, h, nodes, curves, scene))
    return min(gap, 0.0)


@kernel
def arrive(h, clock, nodes, rows, saddle, curves, scene):
    """Rates of the last stage, at the end of the step. Writes: nodes, histories, scene.stages."""
    weigh_pass(h, STAGES - 1, clock, scene)
    clear_forces(nodes)
    force_pass(clock, clock.time + h, h, nodes, rows, curves, scene)
    if JOINTS:
        # D and its factor are those of the projection
        react(clock.time + h, clock, nodes, rows, saddle, curves, scene)
    # a force that begins at the end of the step is no error of the step
    if CONTACTS:
        take_late(nodes, -1.0)
    keep_rates(nodes, rows, scene.stages, STAGES - 1)
    if CONTACTS:
        take_late(nodes, 1.0)


@stage
def judge(h, clock, control, nodes, rows, saddle, scene):
    """0 where the step is accurate, else the length to try. Writes: clock.next_step, fastest."""
    if control.fixed_step > 0.0:
        return 0.0
    speed = clock.fastest if clock.fastest > 0.0 else 1.0
    for k in range(ESTIMATES):
        estimate(nodes, scene.stages, STAGES, scene.E, scene.errors, k, h)
        if JOINTS:
            project_estimate(scene.errors, k, nodes, rows, saddle)
    error = step_error(scene.errors, control.length, speed)
    wanted = next_length(h, error, control.accuracy, ORDER)
    if not error <= control.accuracy:
        return wanted
    # not of an attempt: one that fails may have run away
    clock.fastest = max(clock.fastest, fastest_point(nodes, control.length))
    # a step cut short says little about a longer one
    if h < 0.5 * clock.next_step:
        wanted = max(wanted, clock.next_step)
    clock.next_step = min(wanted, control.step_max)
    return 0.0


@stage
def pass_stages(h, clock, control, nodes, rows, saddle, curves, scene):
    """All stages but the rates of the last. Returns whether the joints could be closed at the end.

    Writes: nodes, rows, scene.stages, new histories.
    """
    for i in range(1, STAGES):
        reach(nodes, scene.stages, scene.A, i, h)
        refresh(nodes)
        if i < STAGES - 1:
            weigh_pass(h, i, clock, scene)
            evaluate(
                clock.time + scene.C[i] * h,
                scene.C[i] * h,
                clock,
                nodes,
                rows,
                saddle,
                curves,
                scene,
            )
            keep_rates(nodes, rows, scene.stages, i)
    if not JOINTS:
        return True
    return project(clock.time + h, clock, control, nodes, rows, saddle, curves, scene)


@kernel
def project(time, clock, control, nodes, rows, saddle, curves, scene):
    """Positions onto Phi = 0 and velocities onto D v = nu. Returns whether it can be done.

    Writes: nodes.r, q, A, v, L, w, W.
    """
    tolerance = min(0.1 * control.constraint_tolerance, 1e-4 * control.accuracy)
    if not close_positions(time, tolerance, clock, control, nodes, rows, saddle, curves, scene):
        return False
    refresh(nodes)
    jacobian(clock.current, time, nodes, rows, curves, scene)
    # also those of the last stage
    factor_constraints(rows, saddle, nodes)
    previous, worst = 1e300, 0.0
    for _ in range(PROJECTIONS):
        velocity_residual(rows, nodes)
        worst = worst_rate(rows, saddle)
        if worst <= tolerance or not worst < 0.5 * previous:
            break
        previous = worst
        clear_joint_forces(nodes)
        solve_rows(saddle, rows, -1.0)
        scatter_delta(rows, nodes)
        kick_by_joints(nodes, 1.0)
    # per second, in the model's size; fast models have larger numbers to round
    limit = control.constraint_tolerance * max(1.0, clock.fastest / control.length)
    if not worst <= limit + spin_round_off(nodes):
        return False
    clock.rate_residual = max(clock.rate_residual, worst)
    return True


@kernel
def close_positions(time, tolerance, clock, control, nodes, rows, saddle, curves, scene):
    """Positions onto Phi = 0 by a simplified Newton's method. Returns whether it can be done.

    D and its factor are those of the last stage, made anew only where they do not serve.
    Writes: nodes.r, q, A.
    """
    previous, worst, is_anew = 1e300, 0.0, False
    for _ in range(PROJECTIONS):
        residual(clock.current, time, nodes, rows, curves, scene)
        worst, clock.place = worst_residual(rows)
        clock.value = worst
        # far better than the step: the error must not add up
        if worst <= tolerance:
            break
        if not worst < 0.5 * previous:
            # as good as it gets
            if is_anew or worst <= control.constraint_tolerance:
                break
            refresh(nodes)
            jacobian(clock.current, time, nodes, rows, curves, scene)
            factor_constraints(rows, saddle, nodes)
            is_anew = True
        previous = worst
        clock.iterations += 1
        solve_rows(saddle, rows, -1.0)
        displace_by_joints(rows, nodes)
    if not worst <= control.constraint_tolerance:
        return False
    clock.residual = max(clock.residual, worst)
    return True


@kernel
def weigh_pass(h, i, clock, scene):
    """Weights of stage i in what is summed over the step. Writes: clock."""
    end = (SAMPLE + 1) * (STAGES - 1)
    clock.stage = i
    clock.opens = 1 if i == 1 else 0
    clock.closes = 1 if i == STAGES - 1 else 0
    clock.lead = h * scene.A[end]
    clock.share = h * scene.A[end + i]


@kernel
def evaluate(time, h, clock, nodes, rows, saddle, curves, scene):
    """Forces and reactions of the present place and velocity. Writes: nodes, rows, outputs,
    new histories.
    """
    clear_forces(nodes)
    force_pass(clock, time, h, nodes, rows, curves, scene)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, curves, scene)
        factor_constraints(rows, saddle, nodes)
        react(time, clock, nodes, rows, saddle, curves, scene)


@kernel
def react(time, clock, nodes, rows, saddle, curves, scene):
    """Reactions of the accelerations (Ambrosio (2003), Eq. 5). Writes: nodes, rows.

    A body of hardly any inertia multiplies the round-off of its reactions, so what they leave of
    the right side is answered again.
    """
    convective(clock.current, time, nodes, rows, curves, scene)
    clear_reaction(rows, nodes)
    acceleration_right_side(rows, nodes)
    first = worst = worst_rate(rows, saddle)
    for _ in range(REFINEMENTS):
        solve_rows(saddle, rows, 1.0)
        scatter_delta(rows, nodes)
        acceleration_right_side(rows, nodes)
        previous, worst = worst, worst_rate(rows, saddle)
        # a row that is redundant at a singular posture keeps what is left
        if worst <= ROUND_OFF * first or not worst < 0.5 * previous:
            break


@stage
def accept(time, h, clock, control):
    """The new state becomes the present one. Writes: clock."""
    clock.time = time
    clock.step = h
    clock.current = 1 - clock.current
    clock.cycle += 1 if h > 0.0 else 0
    if control.fixed_step > 0.0:
        clock.next_step = control.fixed_step
