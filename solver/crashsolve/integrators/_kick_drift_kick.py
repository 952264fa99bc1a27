"""Explicit second-order step for constrained rigid bodies (kick, drift, kick with projections).

    v_half = v + h/2 M^-1 (g + D^T lambda)        lambda such that Phi(q_new) = 0
    q_new  = drift of q by v_half over h
    v_new  = v_half + h/2 M^-1 (g_new + D_new^T mu)   mu such that D_new v_new = nu

The first step that penetrates is cut at the contact's onset. The loop over
time is that of `_advance`.

References: Andersen (1983), J. Comput. Phys. 52, 24-34; Hairer, Lubich and Wanner (2006),
Geometric Numerical Integration, VII.1.4.
"""

from crashsolve.foundation.kernels import stage
from crashsolve.foundation.sparse.saddle import solve_rows
from crashsolve.model.clock import (
    POSITION,
    RUNNING,
    STEP_TOO_SMALL,
)
from crashsolve.system import joint_work
from crashsolve.system.attachments import set_accelerations
from crashsolve.system.constraints import (
    acceleration_right_side,
    clear_reaction,
    clear_trial,
    correct_trial,
    driver_power,
    extrapolate_trial,
    factor_constraints,
    keep_trial,
    kick_by_joints,
    kick_half_by_joints,
    kick_with_joints_and_drift,
    scatter_delta,
    scatter_trial,
    velocity_residual,
    worst_rate,
    worst_residual,
)
from crashsolve.system.contact.resting import record_motion
from crashsolve.system.joint_work import MANY_ITERATIONS
from crashsolve.system.kinetics import (
    accelerations,
    add_impulse,
    apply_deferred,
    begin_force_pass,
    drift,
    first_kick,
    refresh,
    save,
    second_kick,
)
from crashsolve.system.loops.events import approach, approach_before, may_pass
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import convective, jacobian, residual
from crashsolve.system.loops.sensors import measure
from crashsolve.system.loops.unilateral import impulses_of_first_half, impulses_of_second_half
from crashsolve.system.onset import first_gap, narrow_bracket, new_bracket
from crashsolve.system.placeholders import (
    ATTACHMENTS,
    BOUNDS_NEXT_STEP,
    CONTACTS,
    JOINTS,
    RESTING,
    SEPARATING,
    UNILATERAL,
)
from crashsolve.system.timestep import fit, wanted_step

POSITION_ITERATIONS = 40
VELOCITY_ITERATIONS = 4
POOR_PREDICTION = (
    1e-4  # first residual, in model sizes, above which the prediction of lambda is dropped
)


@stage
def prepare_sample(until, clock, nodes, rows, saddle, scene):
    """Residuals of constraints for a sample; returns its time [s]. Writes: rows.phi."""
    if JOINTS:
        residual(clock.current, clock.time, nodes, rows, scene.curves, scene)
    return clock.time


@stage
def take_step(until, clock, nodes, rows, saddle, scene):
    """Positions at the end of a step; returns its time and its length [s]. Writes: nodes, rows."""
    h, is_last = fit(clock.next_step, until - clock.time)
    save(nodes)
    taken = update_positions(h, clock, nodes, rows, saddle, scene)
    time = until if is_last and taken == h else clock.time + taken
    return time, taken


@stage
def finish(time, h, sampling, clock, nodes, rows, saddle, scene):
    """Forces and velocities at the end of the step, or of a sample, which becomes the present."""
    update_velocities(time, h, clock, nodes, rows, saddle, scene)
    accept(time, h, clock, scene.control[0], nodes)
    if sampling:
        accelerations(nodes)
        if ATTACHMENTS:
            set_accelerations(scene.attached_nodes, nodes)
        measure(time, nodes, rows, scene.curves, scene)


@stage
def update_positions(h, clock, nodes, rows, saddle, scene):
    """Positions at the end of the step, cut at the first contact onset. Returns the step taken.

    What did not touch at the start may touch at the end by no more than `allowed`, and may not
    have passed through.
    """
    control = scene.control[0]
    longest, bracket, trial, is_located = h, new_bracket(h), h, False
    while True:
        set_positions(trial, clock, nodes, rows, saddle, scene)
        if not CONTACTS or clock.status != RUNNING:
            break
        if BOUNDS_NEXT_STEP and may_pass(bracket[-1], trial, clock, nodes, scene):
            trial *= 0.5
            longest, bracket = trial, new_bracket(trial)
            continue
        if RESTING:
            record_motion(nodes)
        # without an onset at the end of the full step, the exact gap is not needed
        gap = approach(clock, nodes, scene, 0.0 if bracket[-1] == 0 else -1e300)
        if bracket[-1] == 0:
            before = approach_before(clock, scene)
            # long steps of free flight must not loosen the onset below what a smaller safety
            # requires
            share = 1e-3 * control.safety
            bracket = first_gap(bracket, before, gap, control, share)
        bracket, trial, is_located = narrow_bracket(bracket, longest, trial, gap)
        if is_located:
            break
    clock.located += 1 if bracket[-1] > 0 else 0
    return trial


@stage
def set_positions(h, clock, nodes, rows, saddle, scene):
    """First kick and drift over h, onto the constraints by a simplified Newton on lambda.

    Writes: nodes.*_half, r, q, A, rows.trial.
    """
    control = scene.control[0]
    if JOINTS:
        extrapolate_trial(rows, h / clock.step if clock.step > 0.0 else 0.0)
        scatter_trial(rows, nodes)
    previous, restarted = 1e300, False
    for iteration in range(POSITION_ITERATIONS):
        kick_and_drift(iteration > 0, h, clock, control, nodes, scene)
        if not JOINTS:
            break
        residual(clock.current, clock.time + h, nodes, rows, scene.curves, scene)
        worst, row = worst_residual(rows)
        if is_closed(worst, previous, control):
            clock.residual = max(clock.residual, worst)
            clock.last_iterations = iteration
            break
        if not worst < 1e3 or iteration == POSITION_ITERATIONS - 1:
            clock.status, clock.index, clock.value = POSITION, row, worst
            break
        # with very little inertia the prediction may be far off: begin from zero
        if iteration == 0 and worst > POOR_PREDICTION:
            clear_trial(rows, nodes)
            continue
        # with very different masses, or large rotations within the step, the iteration with D of
        # the start stagnates; beyond a singular configuration its direction is wrong: restart with
        # D of the end
        restart = worst > 0.5 * previous and not restarted
        if restart or (iteration >= 3 and worst > 0.1 * previous):
            refactor_at_end(restart, h, clock, nodes, rows, saddle, scene)
            if restart:
                restarted, previous = True, 1e300
                continue
        previous = worst
        clock.iterations += 1
        solve_rows(saddle, rows, -2.0 / (h * h))
        correct_trial(rows, nodes)


@stage
def kick_and_drift(again, h, clock, control, nodes, scene):
    """First kick, with the joint forces of the present iteration, and drift.

    `again`: positions are those of the half momenta of another trial. Writes: nodes.
    """
    if UNILATERAL:
        first_kick(nodes, h)
        if JOINTS:
            kick_half_by_joints(nodes, 0.5 * h)
        impulses_of_first_half(h, clock, control, nodes, scene)
        drift(nodes, h)
    elif JOINTS:
        kick_with_joints_and_drift(nodes, h, again)
    else:
        first_kick(nodes, h)
        drift(nodes, h)


@stage
def is_closed(worst, previous, control):
    """Whether joints are closed: to a tenth of the tolerance, or to the tolerance at round-off."""
    tolerance = control.constraint_tolerance
    return worst <= 0.1 * tolerance or (worst <= tolerance and worst > 0.5 * previous)


@stage
def refactor_at_end(restart, h, clock, nodes, rows, saddle, scene):
    """Factor the constraints with D of the end; `restart`: of the end without forces of joints.

    Writes: clock, nodes, rows, saddle.
    """
    if restart:
        clear_trial(rows, nodes)
        first_kick(nodes, h)
        drift(nodes, h)
    refresh(nodes)
    clock.factored = 0.0
    jacobian(clock.current, clock.time + h, nodes, rows, scene.curves, scene)
    factor_constraints(rows, saddle, nodes)


@stage
def update_velocities(time, h, clock, nodes, rows, saddle, scene):
    """Forces at the new positions, second kick, velocities onto the constraints.

    With h = 0 the velocities are left and the reactions are those of the accelerations
    (Ambrosio (2003), Eq. 5).
    """
    if h > 0.0:
        if JOINTS:
            clock.driver_work += 0.5 * h * keep_trial(rows)
            if clock.last_iterations >= MANY_ITERATIONS:
                joint_work.add_first_half(scene.control[0], nodes, rows, h)
        add_impulse(clock, nodes, 0.5 * h)
    begin_force_pass(nodes, h)
    clock.opens = clock.closes = 1
    clock.lead = clock.share = 0.5 * h
    force_pass(clock, time, h, nodes, rows, scene.curves, scene)
    if CONTACTS:
        apply_deferred(nodes, -1.0)
    if h > 0.0:
        second_kick(nodes, h)
    if JOINTS:
        # a sample has those of the step that ends there, unless a joint has separated in it
        if SEPARATING or h > 0.0 or clock.factored == 0.0:
            jacobian(clock.current, time, nodes, rows, scene.curves, scene)
            factor_constraints(rows, saddle, nodes)
            clock.factored = h
        clear_reaction(rows, nodes)
        if h > 0.0:
            project_velocity(h, clock, scene.control[0], nodes, rows, saddle)
            clock.driver_work += 0.5 * h * driver_power(rows)
            if clock.last_iterations >= MANY_ITERATIONS:
                joint_work.add_second_half(nodes, rows, h)
        else:
            convective(clock.current, time, nodes, rows, scene.curves, scene)
            acceleration_right_side(rows, nodes)
            solve_rows(saddle, rows, 1.0)
            scatter_delta(rows, nodes)
    if UNILATERAL:
        impulses_of_second_half(h, clock, nodes, scene)
    add_impulse(clock, nodes, 0.5 * h)
    if CONTACTS:
        apply_deferred(nodes, 1.0)


@stage
def project_velocity(h, clock, control, nodes, rows, saddle):
    """D v = nu by the impulses h/2 D^T lambda; more than one iteration only against round-off.

    Writes: nodes.v, L, w, joint_*, rows.reaction.
    """
    velocity_residual(rows, nodes)
    for number in range(VELOCITY_ITERATIONS):
        solve_rows(saddle, rows, -2.0 / h)
        scatter_delta(rows, nodes)
        if number > 0:
            # reactions are sums over iterations: the second kick starts from its beginning
            second_kick(nodes, h)
        kick_by_joints(nodes, 0.5 * h)
        velocity_residual(rows, nodes)
        worst = worst_rate(rows, saddle)
        if worst <= 0.1 * control.constraint_tolerance:
            break
    clock.rate_residual = max(clock.rate_residual, worst)


@stage
def accept(time, h, clock, control, nodes):
    """The new state becomes the present one. Writes: clock."""
    clock.time = time
    clock.step = h
    if h > 0.0:
        clock.kicked_over = h
    clock.current = 1 - clock.current
    clock.next_step = wanted_step(clock, control, nodes)
    clock.cycle += 1 if h > 0.0 else 0
    if clock.next_step < control.step_min:
        clock.status = STEP_TOO_SMALL
