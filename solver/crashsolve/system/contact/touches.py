"""Bookkeeping of contact pairs: onset, slip, application of the force, sums per contact card.

The closing speed is latched at the first evaluation in contact, which the integrator has located
at the true onset. It is reset when the pair separates.
"""

from math import sqrt

from crashsolve.foundation.columns import add_to
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import (
    add_deferred,
    add_stiffness_bound,
    apply_force,
    arm,
    mobility,
    point_at,
    point_velocity,
)
from crashsolve.foundation.vec3 import add_scaled, dot, norm, scale, sub, vec

# share of the half thickness of both sides by which the gap may close in a step; spheres of
# radius R that overlap by less than 6e-4 R as they pass each other may still not be detected
LARGEST_CLOSING = 0.05
# unaccounted energy of friction that is ignored, over the energy exchanged by the normal force
NEGLIGIBLE = 1e-4


@kernel
def clear_cards(cards, deepest):
    """Zero the sums of a force pass, which needs no depth below `deepest` [m]. Writes: cards."""
    for k in range(cards.shape[0]):
        clear_card(cards[k], deepest)


@kernel
def clear_card(c, deepest):
    """Zero the sums of a card, or of a piece of its pairs. Writes: c."""
    for j in range(3):
        c.force[j] = 0.0
    c.normal = c.tangential = c.impact_speed = c.touching = 0.0
    c.stored = c.dissipated = c.friction_dissipated = 0.0
    c.depth = deepest


@kernel
def clear_load(load):
    """Zero the loads of a single pair. Writes: load."""
    for k in range(3):
        load.force[k] = load.torque[k] = 0.0
        load.deferred_force[k] = load.deferred_torque[k] = 0.0
    load.stiffness = load.damping = load.pressed = load.damped = load.slip_rate = 0.0


@kernel
def mark_applied(applied, load_rows, i, now):
    """Mark whether pair i has loads.

    Writes: applied, only where it changes, as threads share it.
    """
    for k in (2 * i, 2 * i + 1):
        if applied[load_rows[k]] != now:
            applied[load_rows[k]] = now


@kernel
def clear_counts(c):
    """Zero the sums of a piece of pairs for the history of its card. Writes: c."""
    for j in range(3):
        c.deferred_force[j] = 0.0
    c.onsets = 0
    c.peak_share = c.work = c.friction_work = c.stored = c.bristle_energy = 0.0


@kernel
def add_load(body, load):
    """Add the loads of a pair to a body. Writes: body."""
    add_to(body.force, vec(load.force))
    add_to(body.torque, vec(load.torque))
    add_to(body.deferred_force, vec(load.deferred_force))
    add_to(body.deferred_torque, vec(load.deferred_torque))
    body.stiffness += load.stiffness
    body.damping += load.damping
    body.pressed += load.pressed
    body.damped += load.damped
    body.slip_rate = max(body.slip_rate, load.slip_rate)


@kernel
def add_sums(card, history, sums, counts):
    """Add the sums of a piece of the pairs of a card. Writes: card, history."""
    add_to(card.force, vec(sums.force))
    card.normal += sums.normal
    card.tangential += sums.tangential
    card.impact_speed = max(card.impact_speed, sums.impact_speed)
    card.touching += sums.touching
    card.stored += sums.stored
    card.depth = max(card.depth, sums.depth)
    card.dissipated += sums.dissipated
    card.friction_dissipated += sums.friction_dissipated
    add_to(history.deferred_force, vec(counts.deferred_force))
    history.onsets += counts.onsets
    history.peak_share = max(history.peak_share, counts.peak_share)
    history.work += counts.work
    history.friction_work += counts.friction_work
    history.stored += counts.stored
    history.bristle_energy += counts.bristle_energy


@kernel
def finish_cards(clock, cards, history):
    """Peaks, impulses and losses per contact card. Writes: history, cards."""
    for k in range(cards.shape[0]):
        c, old, new = cards[k], history[clock.current, k], history[1 - clock.current, k]
        for j in range(3):
            total = new.impulse[j]
            if clock.opens == 1:
                total = old.impulse[j] + clock.lead * old.force_before[j]
            new.impulse[j] = total + clock.share * (c.force[j] - new.deferred_force[j])
            new.force_before[j] = c.force[j]
        c.dissipated += old.left_dissipated
        c.friction_dissipated += old.left_friction_dissipated
        new.left_dissipated = old.left_dissipated
        new.left_friction_dissipated = old.left_friction_dissipated
        new.peak_normal = max(old.peak_normal, c.normal)
        new.peak_depth = max(old.peak_depth, c.depth)
        new.fastest = max(old.fastest, c.impact_speed)
        pushed, friction_loss = (
            new.stored + c.dissipated,
            new.bristle_energy + c.friction_dissipated,
        )
        new.largest_energy = max(old.largest_energy, abs(pushed))
        new.largest_friction_energy = max(old.largest_friction_energy, abs(friction_loss))
        new.exchanged = old.exchanged + abs(new.work - old.work)
        friction_change = abs(new.friction_work - old.friction_work)
        new.friction_exchanged = old.friction_exchanged + friction_change
        if clock.cycle == 0:
            new.initially_stored = pushed + new.work


@kernel
def closing_motion(a, b, x, n):
    """Closing speed, slip velocity of a over b, and arms to the point of contact."""
    d_a = sub(x, vec(a.r))
    d_b = sub(x, vec(b.r))
    v = sub(point_velocity(a, d_a), point_velocity(b, d_b))
    rate = -dot(v, n)
    return rate, add_scaled(v, rate, n), d_a, d_b


@kernel
def pair_mobility(a, b, d_a, d_b, n):
    """Mobilities of both sides along the normal [1/kg]."""
    return mobility(a, d_a, n), mobility(b, d_b, n)


@kernel
def latch(p, old, new, depth, rate, count):
    """Impact speed of this contact. Writes: new, onset count of the card."""
    new.active = 1
    new.depth = depth
    if old.active == 1:
        new.impact_speed = old.impact_speed
    else:
        new.impact_speed = max(rate, 0.0)
        count.onsets += 1


@kernel
def reset_pair(clock, old, new, out, depth, x):
    """Reset histories and outputs of a pair without contact. Writes: new, out."""
    new.active = 0
    new.depth = depth
    new.impact_speed = 0.0
    if clock.opens == 1:
        new.dissipated = old.dissipated
        new.friction_dissipated = old.friction_dissipated
    new.power = new.friction_power = 0.0
    out.stored = out.friction_stored = 0.0
    for k in range(3):
        out.force[k] = 0.0
        out.point[k] = x[k]


@kernel
def applied_fraction(old, depth, rate, h):
    """Share of a step's closing kick that a contact gives: less than 1 where it has just begun.

    A force f that jumps at the onset has acted for the time depth/rate, not for the whole step.
    """
    if old.active == 1 or rate * h <= 0.0:
        return 1.0
    return min(1.0, 2.0 * depth / (rate * h))


@kernel
def onset_factor(clock, old, h):
    """0 for a contact that begins at the end of the step, 1 for any other.

    A step ends where a contact begins. A force that jumps there must not act in a stage at the end:
    it would have the weight of the full step, and no step to the onset would be short enough. A
    stage within the step includes it: a contact that begins and ends within the step shows in the
    error of the step.
    """
    return 0.0 if clock.ends == 1 and old.active == 0 and h > 0.0 else 1.0


@kernel
def apply_contact_force(pair, totals, sliding, applied, f, t, x):
    """Normal force f and friction t on both sides, at the position x. Writes: totals, out."""
    a, b, out, d_a, d_b = totals.on_a, totals.on_b, pair.out, sliding.d_a, sliding.d_b
    total = add_scaled(t, f, sliding.n)
    apply_force(a, total, d_a)
    apply_force(b, scale(-1.0, total), d_b)
    if applied < 1.0:
        add_deferred(a, scale(1.0 - applied, total), d_a)
        add_deferred(b, scale(applied - 1.0, total), d_b)
    for k in range(3):
        out.force[k] = total[k]
        out.point[k] = x[k]


@kernel
def add_pair_stiffness(a, b, mob_a, mob_b, stiffness, damping):
    """Contact stiffness for the step control. Writes: a, b."""
    add_stiffness_bound(a, mob_a, stiffness, damping)
    add_stiffness_bound(b, mob_b, stiffness, damping)


@kernel
def clear_friction_stiffness(nodes):
    """Start the sums of friction stiffness of this force pass. Writes: nodes."""
    for i in range(nodes.shape[0]):
        nodes[i].was_pressed, nodes[i].pressed = nodes[i].pressed, 0.0
        nodes[i].slip_rate = 0.0


@kernel
def friction_compliance(clock, h, pair, totals, mob_a, mob_b, f):
    """Decrease of the slip of a pair in half a step per unit of its friction [s/kg].

    All friction on both bodies together decreases the slip; this pair has the share of its normal
    force f in the sum of f w over the last step. Writes: totals.
    """
    if f <= 0.0:
        return 0.0
    totals.on_a.pressed += f * mob_a
    totals.on_b.pressed += f * mob_b
    total = max(pair.a.was_pressed, f * mob_a) + max(pair.b.was_pressed, f * mob_b)
    return 0.5 * max(h, clock.next_step) * total / f


@kernel
def bound_slip(totals, rate):
    """Report the relative change of a slip [1/s] to the step control. Writes: totals."""
    totals.on_a.slip_rate = max(totals.on_a.slip_rate, rate)
    totals.on_b.slip_rate = max(totals.on_b.slip_rate, rate)


@kernel
def unit_slip(t, slip, n):
    """Unit vector of the friction t, else of the slip, else the normal."""
    size = norm(t)
    if size > 0.0:
        return scale(1.0 / size, t)
    size = norm(slip)
    return scale(1.0 / size, slip) if size > 0.0 else n


@kernel
def predicted_direction(old, slip, n):
    """Unit vector along which friction is predicted to act."""
    return unit_slip(vec(old.friction_force), slip, n)


@kernel
def needs_new_list(clock, elements, nodes, references, slack):
    """Whether an element has moved far since its list of near pairs was made.

    The next step is cut so that none can move farther than `slack` before the next check.
    Writes: clock.next_step.
    """
    farthest, fastest = 0.0, 0.0
    for i in range(elements.shape[0]):
        e = elements[i]
        body = nodes[e.node]
        d = arm(body, vec(e.point))
        v = point_velocity(body, d)
        offset = sub(point_at(body, d), vec(references[i].r))
        farthest = max(farthest, dot(offset, offset))
        fastest = max(fastest, dot(v, v))
    if fastest * clock.next_step**2 > (0.2 * slack) ** 2:
        clock.next_step = 0.2 * slack / sqrt(fastest)
    return farthest > (0.7 * slack) ** 2


@kernel
def closing_speed_bound(p, a, b, nodes):
    """Upper bound of the closing speed of two elements [m/s]."""
    m, w = nodes[a.node], nodes[b.node]
    v_a = point_velocity(m, arm(m, vec(a.point)))
    v_b = point_velocity(w, arm(w, vec(b.point)))
    return norm(sub(v_a, v_b)) + norm(vec(m.w)) * p.spread_a + norm(vec(w.w)) * p.spread_b


@kernel
def add_dissipation(clock, old, new, applied, power, loss, friction_power, friction_loss):
    """Add up the energy lost over the step, as system/energy.py does for others.

    The loss by friction that begins within the step is scaled as its force. Writes: new.
    """
    if clock.opens == 1:
        new.dissipated = old.dissipated + clock.lead * old.power
        new.friction_dissipated = old.friction_dissipated + clock.lead * old.friction_power
    share = clock.share * applied
    new.dissipated += share * power
    new.friction_dissipated += share * friction_power
    if clock.closes == 1:
        new.dissipated += loss
        new.friction_dissipated += applied * friction_loss
    new.power = power
    new.friction_power = friction_power


@kernel
def add_to_card(c, history, order, applied, f, t, new, out):
    """Add one touching pair to its contact card. Writes: c, history."""
    for k in range(3):
        c.force[k] += order * out.force[k]
        history.deferred_force[k] += (1.0 - applied) * order * out.force[k]
    c.depth = max(c.depth, new.depth)
    c.normal += f
    c.tangential += norm(t)
    c.impact_speed = max(c.impact_speed, new.impact_speed)
    c.touching += 1.0
    c.stored += out.stored + out.friction_stored


@kernel
def add_separated(c, new, n):
    """Add a separated pair, and its depth, unless that is only a bound (without a normal).

    Writes: c.
    """
    if dot(n, n) > 0.0:
        c.depth = max(c.depth, new.depth)
    add_losses(c, new)


@kernel
def add_losses(c, new):
    """Add the losses of one pair to its contact card. Writes: c."""
    c.dissipated += new.dissipated
    c.friction_dissipated += new.friction_dissipated


@kernel
def copy_onsets(current, history):
    """Onset counts start from those of the accepted state. Writes: history."""
    for k in range(history.shape[1]):
        new = history[1 - current, k]
        old = history[current, k]
        new.onsets, new.initially_stored = old.onsets, old.initially_stored
        new.peak_share = old.peak_share
        new.work, new.friction_work = old.work, old.friction_work
        new.stored = new.bristle_energy = new.work_rate = new.friction_work_rate = 0.0
        for j in range(3):
            new.deferred_force[j] = 0.0


@kernel
def record_power(applied, f, rate, t, slip, out, count):
    """Record power and stored energy of the forces of a pair in a stage. Writes: count.

    Methods with stages sum it with the weights of the stages, as losses.
    """
    count.work_rate -= applied * f * rate
    count.friction_work_rate += applied * dot(t, slip)
    count.stored += out.stored
    count.bristle_energy += out.friction_stored


@kernel
def integrate_powers(clock, history):
    """Work of all forces in the stages of a step so far. Writes: history."""
    for k in range(history.shape[1]):
        old, new = history[clock.current, k], history[1 - clock.current, k]
        if clock.opens == 1:
            new.work_in_step = clock.lead * old.work_rate
            new.friction_work_in_step = clock.lead * old.friction_work_rate
        new.work_in_step += clock.share * new.work_rate
        new.friction_work_in_step += clock.share * new.friction_work_rate
        new.work = old.work + new.work_in_step
        new.friction_work = old.friction_work + new.friction_work_in_step


@kernel
def card_with_energy_gain(current, limit, unseen, history):
    """First card whose normal force did more work on the bodies than it had stored at the start;
    -1: none.

    The work is that on both sides, so it does not depend on the frame of reference. A gain counts
    where it exceeds `limit` times the energy exchanged, and the work of the largest force over
    `unseen`, the round-off of positions [m].
    """
    for k in range(history.shape[1]):
        card = history[current, k]
        gained = card.work - max(card.initially_stored, 0.0)
        if gained > max(limit * card.exchanged, unseen * card.peak_normal):
            return k
    return -1


@kernel
def card_with_friction_gain(current, limit, unseen, history):
    """The same for friction, which begins without stored energy; less than NEGLIGIBLE of the energy
    exchanged by the normal force is ignored.
    """
    for k in range(history.shape[1]):
        card = history[current, k]
        least = max(limit * card.friction_exchanged, unseen * card.peak_normal)
        if card.friction_work > max(least, NEGLIGIBLE * card.exchanged):
            return k
    return -1
