"""Explicit second-order step for constrained rigid bodies (kick, drift, kick with projections).

    v_half = v + h/2 M^-1 (g + D^T lambda)        lambda such that Phi(q_new) = 0
    q_new  = drift of q by v_half over h
    v_new  = v_half + h/2 M^-1 (g_new + D_new^T mu)   mu such that D_new v_new = nu

The first step that penetrates is cut at the contact's onset. This file is the recital; compose
puts the scene's own functions in the place of `scene` and compiles both together.

References: Andersen (1983), J. Comput. Phys. 52, 24-34; Hairer, Lubich and Wanner (2006),
Geometric Numerical Integration, VII.1.4.
"""

from crashsolve.foundation.compile import inlined, kernel
from crashsolve.foundation.saddle import solve_delta, solve_reaction
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
    driver_power,
    extrapolate_trial,
    factor_constraints,
    keep_trial,
    kick_by_joints,
    kick_half_by_joints,
    scatter_delta,
    scatter_reaction,
    scatter_trial,
    start_multipliers,
    velocity_residual,
    worst_residual,
)
from crashsolve.system.energy import balance_broken
from crashsolve.system.kinetics import (
    accelerations,
    add_impulse,
    bad_node,
    clear_forces,
    drift,
    kick_end,
    kick_off,
    predict,
    refresh,
    save,
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
from crashsolve.system.timestep import fit, onset_step, wanted_step

ORDER = 2
POSITION_ITERATIONS = 40


@kernel
def advance(until, clock, control, nodes, rows, saddle, curves, groups, ledger):
    """Step from the present time to exactly `until` [s], or to trouble. Writes: all of the State."""
    clock.status = RUNNING
    while clock.time < until:
        h, is_last = fit(clock.next_step, until - clock.time)
        save(nodes)
        taken = move(h, clock, control, nodes, rows, saddle, curves, groups)
        if clock.status != RUNNING:
            return
        time = until if is_last and taken == h else clock.time + taken
        push(time, taken, clock, nodes, rows, saddle, curves, groups)
        clock.time = time
        clock.step = taken
        clock.cycle += 1
        clock.current = 1 - clock.current
        clock.next_step = wanted_step(clock, control, nodes)
        guard(clock, control, nodes, curves, groups, ledger)
        if clock.status != RUNNING:
            return
    clock.status = REACHED


@kernel
def prepare(clock, control, nodes, rows, saddle, curves, groups):
    """Forces and constraints of the initial state, before the first step. Writes: the State."""
    clear_forces(nodes)
    refresh(nodes)
    if JOINTS:
        residual(clock.current, clock.time, nodes, rows, curves, groups)
        jacobian(clock.current, clock.time, nodes, rows, curves, groups)
        factor_constraints(rows, saddle, nodes)
    force_pass(clock.current, clock.time, 0.0, nodes, rows, curves, groups)
    clock.current = 1 - clock.current
    if JOINTS:
        find_reaction(clock, nodes, rows, saddle, curves, groups)
        start_multipliers(rows)
    clock.next_step = wanted_step(clock, control, nodes)


@kernel
def sample(clock, nodes, rows, saddle, curves, groups, ledger):
    """Outputs, reactions and accelerations of the present state.

    The caller passes copies of nodes and rows, so that the State is not changed.
    Writes: nodes, rows, outputs of groups, the histories that are not current, ledger.
    """
    clear_forces(nodes)
    force_pass(clock.current, clock.time, 0.0, nodes, rows, curves, groups)
    if JOINTS:
        find_reaction(clock, nodes, rows, saddle, curves, groups)
    accelerations(nodes)
    measure(clock.time, nodes, rows, curves, groups)
    energy(clock, nodes, groups, ledger)


@inlined
def move(h, clock, control, nodes, rows, saddle, curves, groups):
    """Positions at the end of the step, cut at the first contact onset. Returns the step taken."""
    place(h, clock, control, nodes, rows, saddle, curves, groups)
    late = h
    if CONTACTS:
        early, tried = 0.0, h
        gap_early = approach_before(clock.current, groups)
        gap_late = approach(clock.current, nodes, groups)
        allowed = max(control.onset_tolerance, 1e-4 * (gap_late - gap_early))
        count = 0
        # what did not touch before may touch now by no more than `allowed`
        while clock.status == RUNNING and gap_late > allowed and late - early > 1e-13 * h:
            tried = onset_step(count, early, gap_early, late, gap_late, allowed)
            place(tried, clock, control, nodes, rows, saddle, curves, groups)
            gap = approach(clock.current, nodes, groups)
            if gap >= 0.0:
                late, gap_late = tried, gap
            else:
                early, gap_early = tried, gap
            count += 1
        if tried != late:
            place(late, clock, control, nodes, rows, saddle, curves, groups)
        clock.located += 1 if count > 0 else 0
    return late


@kernel
def place(h, clock, control, nodes, rows, saddle, curves, groups):
    """First kick and drift over h, onto the constraints. Writes: nodes.*_half, r, q, A."""
    kick_off(nodes, h)
    if JOINTS:
        extrapolate_trial(rows, h / clock.step if clock.step > 0.0 else 0.0)
        scatter_trial(rows, nodes)
        kick_half_by_joints(nodes, 0.5 * h)
    drift(nodes, h)
    if JOINTS:
        correct(h, clock, control, nodes, rows, saddle, curves, groups)


@inlined
def correct(h, clock, control, nodes, rows, saddle, curves, groups):
    """Simplified Newton on lambda until Phi(q_new) vanishes. Writes: rows.trial, nodes."""
    previous = 1e300
    for iteration in range(POSITION_ITERATIONS):
        residual(clock.current, clock.time + h, nodes, rows, curves, groups)
        worst, row = worst_residual(rows)
        # two decimals better than asked, or as good as asked and stalled at round-off
        if worst <= 0.01 * control.constraint_tolerance:
            break
        if worst <= control.constraint_tolerance and worst > 0.5 * previous:
            break
        if not worst < 1e3 or iteration == POSITION_ITERATIONS - 1:
            clock.status, clock.place, clock.value = POSITION, row, worst
            break
        previous = worst
        solve_delta(saddle, rows, -2.0 / (h * h))
        scatter_delta(rows, nodes)
        kick_half_by_joints(nodes, 0.5 * h)
        drift(nodes, h)
        clock.iterations += 1
    clock.residual = max(clock.residual, worst)


@inlined
def push(time, h, clock, nodes, rows, saddle, curves, groups):
    """Forces at the new positions, second kick, velocities onto the constraints."""
    if JOINTS:
        keep_trial(rows)
        scatter_trial(rows, nodes)
        clock.driver_work += 0.5 * h * driver_power(rows)
    add_impulse(clock, nodes, 0.5 * h)
    predict(nodes, h)
    refresh(nodes)
    clear_forces(nodes)
    force_pass(clock.current, time, h, nodes, rows, curves, groups)
    kick_end(nodes, h)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, curves, groups)
        factor_constraints(rows, saddle, nodes)
        velocity_residual(rows, nodes)
        solve_reaction(saddle, rows, -2.0 / h)
        scatter_reaction(rows, nodes)
        kick_by_joints(nodes, 0.5 * h)
        clock.driver_work += 0.5 * h * driver_power(rows)
    add_impulse(clock, nodes, 0.5 * h)


@inlined
def find_reaction(clock, nodes, rows, saddle, curves, groups):
    """Ambrosio (2003), Eq. 5 at the present state: lambda. Writes: rows.reaction, nodes."""
    convective(clock.current, clock.time, nodes, rows, curves, groups)
    acceleration_right_side(rows, nodes)
    solve_reaction(saddle, rows, 1.0)
    scatter_reaction(rows, nodes)


@inlined
def guard(clock, control, nodes, curves, groups, ledger):
    """Stop at a bad number, a curve read past its end, a collapsed step or a broken balance."""
    if curves[0].fault > 0:
        clock.status = CURVE_END
    elif clock.next_step < control.step_min:
        clock.status = STEP_TOO_SMALL
    elif clock.cycle % control.check_every == 0:
        clock.place = bad_node(nodes)
        energy(clock, nodes, groups, ledger)
        if clock.place >= 0:
            clock.status = NOT_FINITE
        elif balance_broken(ledger, control.energy_limit):
            clock.status = ENERGY
    if REBUILDS and clock.status == RUNNING and need_rebuild(nodes, groups):
        clock.status = REBUILD
