"""Unilateral constraints within a step: active pairs, impulses in both halves, losses.

    v_half = v + h/2 M^-1 g + M^-1 P        P >= 0 such that no active pair goes deeper in the drift
    v_new = v_half + h/2 M^-1 g_new + M^-1 P_new         such that no active pair approaches

The drift ends at the onset of a new contact, which is active after the second half. Impulses on
several pairs of one body are found by sweeps (Gauss-Seidel); one sweep is enough where no node has
two pairs. Between impacts the order is that of the step, 2.
"""

from typing import NamedTuple

import numpy as np

from crashsolve.contact.unilateral import unilateral_impulse
from crashsolve.foundation.columns import add_to, matvec
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import apply_force, mobility
from crashsolve.foundation.vec3 import ZERO, add, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.system.contact.touches import add_losses, reset_pair, unit_slip
from crashsolve.system.kinetics import drift_body

MAX_ITERATIONS = 20  # over the drift, until gaps on curved surfaces are closed
SWEEPS = 200  # over the pairs, until their impulses agree
CONVERGED = 1e-14  # change of an impulse in a sweep, over the largest, that is round-off
LARGEST_GAP = 1e-12  # gap of an active pair, in model sizes


class Pairs(NamedTuple):
    """Tables of a group of pairs: parameters, histories, outputs, elements of both sides."""

    parameters: np.ndarray
    history: np.ndarray
    output: np.ndarray
    elements: tuple[np.ndarray, np.ndarray]


@kernel
def clear_impulses(current, history):
    """Zero the impulses of a step. Writes: new history."""
    for i in range(history.shape[1]):
        new = history[1 - current, i]
        put(new.opening, ZERO)
        new.lift = new.friction_loss = 0.0


@kernel
def velocity(is_half, b, d):
    """Velocity of the point d from the mass centre, at half step or at the end [m/s]."""
    v, L = (b.v_half, b.L_half) if is_half else (b.v, b.L)
    return add(vec(v), cross(matvec(b.W, vec(L)), d))


@kernel
def relative_velocity(is_half, contact, m, w):
    """Velocity of side a over side b in their point of contact [m/s]."""
    return sub(velocity(is_half, m, vec(contact.arm_a)), velocity(is_half, w, vec(contact.arm_b)))


@kernel
def apply_impulse(is_half, b, P, d):
    """Apply an impulse P at d from the mass centre. Writes: b."""
    v, L = (b.v_half, b.L_half) if is_half else (b.v, b.L)
    add_to(v, scale(b.mass_inv, P))
    if b.mass_inv > 0.0:
        add_to(L, cross(d, P))


@kernel
def sweep(is_half, is_impulse, current, pairs, nodes, change, most):
    """New impulses of every active pair, one after the other; at an impact of new ones too.

    Takes and returns the largest change and the largest impulse [N s]. Writes: history, nodes.
    """
    params, history, _, elements = pairs
    for i in range(params.shape[0]):
        p, old, new = params[i], history[current, i], history[1 - current, i]
        if (old.active == 0 and not is_impulse) or (new.active == 0 and not is_half):
            continue
        contact = old if is_half else new
        P = new.opening if is_half else (new.impulse if is_impulse else new.closing)
        m, w = nodes[elements[0][p.a].node], nodes[elements[1][p.b].node]
        d_a, d_b, n = vec(contact.arm_a), vec(contact.arm_b), vec(contact.normal)
        u = relative_velocity(is_half, contact, m, w)
        slip = unit_slip(ZERO, add_scaled(u, -dot(u, n), n), n)
        wanted = unilateral_impulse(
            p,
            vec(P),
            u,
            n,
            new.lift if is_half else 0.0,
            mobility(m, d_a, n) + mobility(w, d_b, n),
            mobility(m, d_a, slip) + mobility(w, d_b, slip),
        )
        more = sub(wanted, vec(P))
        put(P, wanted)
        apply_impulse(is_half, m, more, d_a)
        apply_impulse(is_half, w, scale(-1.0, more), d_b)
        change, most = max(change, norm(more)), max(most, norm(wanted))
    return change, most


@kernel
def drift_active_pairs(current, h, params, history, elements, nodes):
    """Move the bodies of all active pairs by their momenta at half step. Writes: nodes.r, q, A."""
    for i in range(params.shape[0]):
        if history[current, i].active == 0:
            continue
        for k in (elements[0][params[i].a].node, elements[1][params[i].b].node):
            if k > 0:
                drift_body(nodes[k], h)


@kernel
def correct_lift(old, new, depth, h):
    """Correct the velocity that closes the gap over a drift; returns the size of the gap [m].
    Writes: new.

    A pair without an impulse may separate.
    """
    if depth <= 0.0 and dot(vec(new.opening), vec(old.normal)) <= 0.0:
        return 0.0
    new.lift += depth / h
    return abs(depth)


@kernel
def add_friction_loss(current, params, history, elements, nodes):
    """Friction's loss in the first half: impulse times mean velocity. Writes: new history."""
    for i in range(params.shape[0]):
        p, old, new = params[i], history[current, i], history[1 - current, i]
        if old.active == 1:
            m, w = nodes[elements[0][p.a].node], nodes[elements[1][p.b].node]
            u = add(relative_velocity(False, old, m, w), relative_velocity(True, old, m, w))
            new.friction_loss = -0.5 * dot(tangential_part(vec(new.opening), vec(old.normal)), u)


@kernel
def tangential_part(x, n):
    """Part of a vector across the unit vector n."""
    return add_scaled(x, -dot(x, n), n)


@kernel
def update_pair(clock, h, pair, meeting):
    """Whether a pair is active after the drift, and its point of contact. Writes: pair.new, out.

    An active pair is released where it has no impulse and its gap is open. A sample changes
    nothing.
    """
    old, new, out, m, w = pair.old, pair.new, pair.out, pair.a, pair.b
    depth, n, x = meeting.depth, meeting.n, meeting.x
    if h <= 0.0:
        new.active = old.active
    elif old.active == 1:
        is_pushed = dot(vec(new.opening), vec(old.normal)) > 0.0
        new.active = 1 if depth >= 0.0 or is_pushed else 0
    else:
        new.active = 1 if depth >= 0.0 else 0
    put(new.normal, n)
    put(new.arm_a, sub(x, vec(m.r)))
    put(new.arm_b, sub(x, vec(w.r)))
    put(new.reaction, vec(old.reaction) if h <= 0.0 else ZERO)
    put(new.closing, ZERO)
    put(new.impulse, ZERO)
    is_held, speed = new.active, old.impact_speed
    reset_pair(clock, old, new, out, depth, x)
    new.active = is_held
    new.impact_speed = speed if is_held == 1 else 0.0


@kernel
def record_reactions(h, current, params, history, elements, nodes):
    """Reactions of the active pairs in the second half, and their loss by friction. Writes: new
    history.

    Returns the number of new pairs; their velocity is stored for `record_impulses`.
    """
    count = 0
    for i in range(params.shape[0]):
        p, old, new = params[i], history[current, i], history[1 - current, i]
        if new.active == 0:
            continue
        m, w = nodes[elements[0][p.a].node], nodes[elements[1][p.b].node]
        put(new.velocity_before, relative_velocity(False, new, m, w))
        if old.active == 0:
            count += 1
            continue
        put(new.reaction, scale(2.0 / h, vec(new.closing)))
        u = add(relative_velocity(True, new, m, w), vec(new.velocity_before))
        new.friction_loss -= 0.5 * dot(tangential_part(vec(new.closing), vec(new.normal)), u)
    return count


@kernel
def record_impulses(current, params, history, elements, nodes, cards):
    """Losses of impacts, by their impulses times mean velocities. Writes: new history, cards."""
    for i in range(params.shape[0]):
        p, old, new = params[i], history[current, i], history[1 - current, i]
        if new.active == 0:
            continue
        m, w = nodes[elements[0][p.a].node], nodes[elements[1][p.b].node]
        u, n, P = (
            add(relative_velocity(False, new, m, w), vec(new.velocity_before)),
            vec(new.normal),
            vec(new.impulse),
        )
        new.dissipated -= 0.5 * dot(P, n) * dot(u, n)
        new.friction_loss -= 0.5 * dot(tangential_part(P, n), u)
        if old.active == 0:
            new.impact_speed = max(-dot(vec(new.velocity_before), n), 0.0)
            cards[1 - current, p.card].onsets += 1


@kernel
def finish_pairs(h, clock, pairs, nodes, cards, card_history):
    """Sums of every pair: losses, impulses, outputs; at a sample, forces. Writes: all of these."""
    params, history, output, elements = pairs
    for i in range(params.shape[0]):
        p, new, out = params[i], history[1 - clock.current, i], output[i]
        card, card_new = cards[p.card], card_history[1 - clock.current, p.card]
        if new.active == 1:
            at_a, at_b = elements[0][p.a].node, elements[1][p.b].node
            m, w, R = nodes[at_a], nodes[at_b], vec(new.reaction)
            put(out.force, R)
            if h > 0.0:
                new.friction_dissipated += new.friction_loss
                put(m.w, matvec(m.W, vec(m.L)))
                put(w.w, matvec(w.W, vec(w.L)))
                sum_impulse(clock, p, history[clock.current, i], new, at_a, at_b, nodes, card_new)
            else:
                apply_force(m, R, vec(new.arm_a))
                apply_force(w, scale(-1.0, R), vec(new.arm_b))
            sum_force(card, p.order, R, vec(new.normal), new.impact_speed)
            card_new.peak_normal = max(card_new.peak_normal, card.normal)
        card.depth = max(card.depth, new.depth)
        add_losses(card, new)


@kernel
def sum_force(card, order, R, n, impact_speed):
    """Add the reaction R of one pair to its contact card. Writes: card."""
    for k in range(3):
        card.force[k] += order * R[k]
    card.normal += dot(R, n)
    card.tangential += norm(tangential_part(R, n))
    card.impact_speed = max(card.impact_speed, impact_speed)
    card.touching += 1.0


@kernel
def sum_impulse(clock, p, old, new, at_a, at_b, nodes, card):
    """Add the impulses of a step to the card, and to those on the model where one side is the
    ground. Writes: both.
    """
    first = vec(new.opening)
    last = add(vec(new.closing), vec(new.impulse))
    total = add(first, last)
    for k in range(3):
        card.impulse[k] += p.order * total[k]
    if at_a > 0 and at_b > 0:
        return
    sign = 1.0 if at_b == 0 else -1.0
    body = nodes[at_a] if at_b == 0 else nodes[at_b]
    d, d_new = (old.arm_a, new.arm_a) if at_b == 0 else (old.arm_b, new.arm_b)
    early = cross(add(vec(body.start_r), vec(d)), first)
    late = cross(add(vec(body.r), vec(d_new)), last)
    for k in range(3):
        clock.impulse[k] += sign * total[k]
        clock.angular_impulse[k] += sign * (early[k] + late[k])
