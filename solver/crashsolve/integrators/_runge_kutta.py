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

from crashsolve.foundation.compile import entry, kernel, stage  # noqa: F401  (the scene uses kernel)
from crashsolve.foundation.saddle import Saddle, solve_rows
from crashsolve.integrators.dormand_prince_5 import ORDER, STAGES
from crashsolve.model.clock import (
    CURVE_END,
    ENERGY,
    NOT_FINITE,
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
from crashsolve.system.energy import balance_broken
from crashsolve.system.kinetics import (
    accelerations,
    bad_node,
    clear_forces,
    refresh,
    save,
    take_late,
)
from crashsolve.system.scene import (
    CONTACTS,
    JOINTS,
    REBUILDS,
    approach,
    approach_before,
    convective,
    energy,
    force_pass,
    jacobian,
    measure,
    need_rebuild,
    residual,
)
from crashsolve.system.stages import (
    add_outside,
    displace_by_joints,
    fastest_point,
    keep_rates,
    next_length,
    reach,
    step_error,
    typical_speed,
)
from crashsolve.system.timestep import first_depth, fit, onset_step, wanted_step

PROJECTIONS = 10


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
            if JOINTS:
                residual(clock.current, time, nodes, rows, curves, scene)
            refresh(nodes)
            weigh_pass(0.0, 0, clock, scene)
            clock.opens = clock.closes = 1
            evaluate(time, 0.0, clock, nodes, rows, saddle, curves, scene)
            accelerations(nodes)
            measure(time, nodes, rows, curves, scene)
            if clock.next_step <= 0.0:
                begin(clock, control, nodes)
            h = 0.0
        else:
            if REBUILDS and need_rebuild(clock, nodes, scene):
                clock.status = REBUILD
                return
            h, is_last = fit(clock.next_step, until - clock.time)
            save(nodes)
            keep_rates(nodes, rows, scene.stages, 0)
            taken = take(h, clock, control, nodes, rows, saddle, curves, scene)
            time = until if is_last and taken == h else clock.time + taken
            h = taken
            if clock.status != RUNNING:
                return
            add_outside(clock, scene.stages, scene.A, h)
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
    early, late, trial, count = 0.0, h, h, 0
    gap_early, gap_late, allowed = 0.0, 0.0, 0.0
    while True:
        closed = pass_stages(trial, clock, control, nodes, rows, saddle, curves, scene)
        if not closed:
            # too long for the joints: as if the error were large
            clock.rejected += 1
            trial = late = 0.25 * trial
            early, count = 0.0, 0
            if trial < control.step_min:
                clock.status = POSITION
                break
            continue
        if CONTACTS:
            gap = approach(clock.current, nodes, scene)
            if count == 0:
                gap_early = approach_before(clock.current, scene)
                allowed = first_depth(control, gap - gap_early)
            if gap >= 0.0 or count == 0:
                late, gap_late = trial, gap
            else:
                early, gap_early = trial, gap
            if not (trial == late and (gap_late <= allowed or late - early <= 1e-13 * h)):
                trial = onset_step(count, early, gap_early, late, gap_late, allowed)
                if late - early <= 1e-13 * h or gap_late <= allowed:
                    trial = late
                count += 1
                continue
        arrive(trial, clock, nodes, rows, saddle, curves, scene)
        if control.fixed_step > 0.0:
            break
        wanted = judge(trial, clock, control, nodes, scene)
        if wanted == 0.0:
            break
        clock.rejected += 1
        trial = late = clock.next_step = wanted
        early, count = 0.0, 0
        if trial < control.step_min:
            clock.status = STEP_TOO_SMALL
            break
    clock.located += 1 if count > 0 else 0
    return trial


@stage
def arrive(h, clock, nodes, rows, saddle, curves, scene):
    """Rates of the last stage, at the end of the step. Writes: nodes, histories, scene.stages."""
    weigh_pass(h, STAGES - 1, clock, scene)
    evaluate(clock.time + h, h, clock, nodes, rows, saddle, curves, scene)
    # a force that begins at the end of the step is no error of the step
    if CONTACTS:
        take_late(nodes, -1.0)
    keep_rates(nodes, rows, scene.stages, STAGES - 1)
    if CONTACTS:
        take_late(nodes, 1.0)


@stage
def judge(h, clock, control, nodes, scene):
    """0 where the step is accurate, else the length to try. Writes: clock.next_step, fastest."""
    speed = clock.fastest if clock.fastest > 0.0 else 1.0
    error = step_error(nodes, scene.stages, scene.E, scene.E_LOW, h, control.length, speed)
    wanted = next_length(h, error, control.accuracy, ORDER)
    if not error <= control.accuracy:
        return wanted
    # not of an attempt: one that fails may have run away
    clock.fastest = max(clock.fastest, fastest_point(nodes, control.length))
    # a step cut short by a sample says little about a longer one
    if h < clock.next_step:
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


@stage
def project(time, clock, control, nodes, rows, saddle, curves, scene):
    """Positions onto Phi = 0 and velocities onto D v = nu. Returns whether it can be done.

    Writes: nodes.r, q, A, v, L, w, W.
    """
    jacobian(clock.current, time, nodes, rows, curves, scene)
    factor_constraints(rows, saddle, nodes)
    tolerance = min(0.1 * control.constraint_tolerance, 1e-4 * control.accuracy)
    previous, worst = 1e300, 0.0
    for _ in range(PROJECTIONS):
        residual(clock.current, time, nodes, rows, curves, scene)
        worst, clock.place = worst_residual(rows)
        clock.value = worst
        # far better than the step, or as good as it gets: the error must not add up
        if worst <= tolerance or not worst < 0.5 * previous:
            break
        previous = worst
        clock.iterations += 1
        clear_joint_forces(nodes)
        solve_rows(saddle, rows, -1.0)
        scatter_delta(rows, nodes)
        displace_by_joints(nodes)
    if not worst <= control.constraint_tolerance:
        return False
    clock.residual = max(clock.residual, worst)
    refresh(nodes)
    jacobian(clock.current, time, nodes, rows, curves, scene)
    previous = 1e300
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
    if not worst <= control.constraint_tolerance * max(1.0, clock.fastest / control.length):
        return False
    clock.rate_residual = max(clock.rate_residual, worst)
    return True


@stage
def weigh_pass(h, i, clock, scene):
    """Weights of stage i in what is summed over the step. Writes: clock."""
    end = STAGES * (STAGES - 1)
    clock.opens = 1 if i == 1 else 0
    clock.closes = 1 if i == STAGES - 1 else 0
    clock.lead = h * scene.A[end]
    clock.share = h * scene.A[end + i]


@kernel
def evaluate(time, h, clock, nodes, rows, saddle, curves, scene):
    """Forces and reactions of the present place and velocity (Ambrosio (2003), Eq. 5).

    Writes: nodes, rows, outputs, new histories.
    """
    clear_forces(nodes)
    force_pass(clock, time, h, nodes, rows, curves, scene)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, curves, scene)
        factor_constraints(rows, saddle, nodes)
        convective(clock.current, time, nodes, rows, curves, scene)
        acceleration_right_side(rows, nodes)
        clear_reaction(rows, nodes)
        solve_rows(saddle, rows, 1.0)
        scatter_delta(rows, nodes)


@stage
def accept(time, h, clock, control):
    """The new state becomes the present one. Writes: clock."""
    clock.time = time
    clock.step = h
    clock.current = 1 - clock.current
    clock.cycle += 1 if h > 0.0 else 0
    if control.fixed_step > 0.0:
        clock.next_step = control.fixed_step


@stage
def check(clock, control, nodes, ledger):
    """Stop at a bad number or a broken balance. Writes: clock."""
    bad = bad_node(nodes)
    if bad >= 0:
        clock.status, clock.place = NOT_FINITE, bad
    elif clock.cycle >= control.check_every and balance_broken(ledger, control.energy_limit):
        clock.status = ENERGY
