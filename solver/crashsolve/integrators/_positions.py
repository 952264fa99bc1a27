"""Positions, reactions and closed joints: shared by the steppers that choose their steps by error.

    M v_dot = g + D^T lambda,   D v_dot = gamma       at a position and velocity
    q onto Phi = 0,   v onto D v = nu                 by the least change that the inertia allows

Reference: Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482 (coordinate projection).
"""

from math import sqrt

from crashsolve.foundation.kernels import inlined, kernel, stage
from crashsolve.foundation.sparse.saddle import REDUNDANT, solve_rows
from crashsolve.model.clock import POSITION, VELOCITY
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
from crashsolve.system.implicit.stages import (
    displace_by_joints,
    record_kick,
    spin_round_off,
    typical_speed,
)
from crashsolve.system.kinetics import apply_deferred, clear_forces, has_deferred, refresh
from crashsolve.system.loops.events import approach, event
from crashsolve.system.loops.forces import force_pass
from crashsolve.system.loops.joints import convective, jacobian, residual
from crashsolve.system.placeholders import CONTACTS, EVENTS, JOINTS
from crashsolve.system.timestep import wanted_step

PROJECTIONS = 10
REFINEMENTS = 3
# of the tolerance: residual of rows that are nearly redundant (a linkage near its flat
# configuration), which no impulse corrects; the errors of some hundred steps add up there
REDUNDANT_SHARE = 100.0 * sqrt(REDUNDANT)
ROUND_OFF = 1e-12  # of an acceleration, or of the model's size


@stage
def begin(clock, control, nodes):
    """A first guess of the step, and the speed that errors are compared to. Writes: clock."""
    clock.fastest = typical_speed(nodes, control.length)
    clock.next_step = wanted_step(clock, control, nodes)
    clock.limit_node = 0
    if clock.fastest > 0.0:
        clock.fastest = max(clock.fastest, control.least_speed)
        clock.next_step = min(clock.next_step, 0.01 * control.length / clock.fastest)


@kernel
def onset_gap(h, clock, nodes, scene):
    """Largest depth of the events in a step of h: onset or end of a contact, or a branch of a
    law.
    """
    gap = -1e300
    if CONTACTS:
        gap = approach(clock, nodes, scene, -1e300)
    if EVENTS:
        # a state that rests at a corner passes it by round-off in every step
        past = event(clock.current, h, nodes, scene.curves, scene)
        past -= ROUND_OFF * scene.control[0].length
        gap = max(gap, past)
    return gap


@inlined
def closing_tolerance(control):
    """To which joints are closed after a step, in the model's size and per second of it."""
    return min(0.1 * control.constraint_tolerance, 1e-4 * control.tolerance)


@kernel
def project(time, tolerance, clock, nodes, rows, saddle, scene):
    """Positions onto Phi = 0 and velocities onto D v = nu. Returns whether it can be done.

    Writes: nodes.r, q, A, v, L, w, W.
    """
    control = scene.control[0]
    if not close_positions(time, tolerance, clock, nodes, rows, saddle, scene):
        return False
    refresh(nodes)
    jacobian(clock.current, time, nodes, rows, scene.curves, scene)
    # D of the last stage is replaced too
    factor_constraints(rows, saddle, nodes)
    previous, worst = 1e300, 0.0
    for k in range(6):
        clock.kick[k] = 0.0
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
        record_kick(clock, nodes)
    # per second, in the model's size; fast models have larger numbers to round
    limit = control.constraint_tolerance + REDUNDANT_SHARE * control.tolerance
    limit *= max(1.0, clock.fastest / control.length)
    is_held = worst <= limit + spin_round_off(nodes)
    if is_held:
        clock.rate_residual = max(clock.rate_residual, worst)
    else:
        clock.fault = VELOCITY
    return is_held


@kernel
def close_positions(time, tolerance, clock, nodes, rows, saddle, scene):
    """Positions onto Phi = 0 by a simplified Newton's method. Returns whether it can be done.

    D and its factor are those of the last stage; they are renewed only where the iteration
    stagnates. Writes: nodes.r, q, A.
    """
    control = scene.control[0]
    previous, worst, is_refactored = 1e300, 0.0, False
    for _ in range(PROJECTIONS):
        residual(clock.current, time, nodes, rows, scene.curves, scene)
        worst, clock.index = worst_residual(rows)
        clock.value = worst
        # far below the error of a step, so that it does not accumulate
        if worst <= tolerance:
            break
        if not worst < 0.5 * previous:
            # stagnates
            if is_refactored or worst <= control.constraint_tolerance:
                break
            refresh(nodes)
            jacobian(clock.current, time, nodes, rows, scene.curves, scene)
            factor_constraints(rows, saddle, nodes)
            is_refactored = True
        previous = worst
        clock.iterations += 1
        solve_rows(saddle, rows, -1.0)
        displace_by_joints(rows, nodes)
    if not worst <= control.constraint_tolerance:
        clock.fault = POSITION
        return False
    clock.residual = max(clock.residual, worst)
    return True


@kernel
def begin_at_event(clock, control, nodes):
    """Cut the step that begins where something does to what resolves the present stiffnesses.

    A contact that has just begun states that of its greatest depth to come. A much longer step
    moves stages through what is struck to where no force acts, and its error may be small by
    chance. Writes: clock.
    """
    clock.located += 1
    clock.next_step = min(clock.next_step, wanted_step(clock, control, nodes))
    clock.limit_node = 0


@kernel
def evaluate(time, h, clock, nodes, rows, saddle, scene):
    """Forces and reactions at the present position and velocity, without contacts that begin there.

    Writes: nodes, rows, outputs, new histories.
    """
    clear_forces(nodes)
    force_pass(clock, time, h, nodes, rows, scene.curves, scene)
    if CONTACTS:
        apply_deferred(nodes, -1.0)
    if JOINTS:
        jacobian(clock.current, time, nodes, rows, scene.curves, scene)
        factor_constraints(rows, saddle, nodes)
        solve_reactions(time, clock, nodes, rows, saddle, scene)


@kernel
def begin_contacts(time, clock, nodes, rows, saddle, scene):
    """After the step, the forces of contacts that begin at its end. Writes: nodes, rows."""
    if has_deferred(nodes):
        apply_deferred(nodes, 1.0)
        if JOINTS:
            solve_reactions(time, clock, nodes, rows, saddle, scene)


@kernel
def solve_reactions(time, clock, nodes, rows, saddle, scene):
    """Reactions of the accelerations (Ambrosio (2003), Eq. 5). Writes: nodes, rows.

    A body of very little inertia multiplies the round-off of its reactions, hence the iterative
    refinement.
    """
    convective(clock.current, time, nodes, rows, scene.curves, scene)
    clear_reaction(rows, nodes)
    acceleration_right_side(rows, nodes)
    first = worst = worst_rate(rows, saddle)
    # far below the error of a step
    allowed = max(ROUND_OFF, 1e-4 * scene.control[0].tolerance)
    for _ in range(REFINEMENTS):
        solve_rows(saddle, rows, 1.0)
        scatter_delta(rows, nodes)
        acceleration_right_side(rows, nodes)
        previous, worst = worst, worst_rate(rows, saddle)
        # the residual of a row that is redundant at a singular configuration remains
        if worst <= allowed * first or not worst < 0.5 * previous:
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
