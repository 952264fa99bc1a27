"""Contact pairs of one group: gap, normal force and friction, on both bodies.

Sides that lie on each other over an area press in its points, each with its own closing speed, and
friction may resist a spin (system/contact/areas.py). A contact may continue on another face than
the nearest (system/contact/pass_through.py), and a pair that cannot have met is skipped
(system/contact/resting.py), together with all others of its two bodies
(system/contact/body_pairs.py).
"""

from crashsolve.foundation.kernels import apart, kernel, stage
from crashsolve.system.contact import (
    areas,
    body_pairs,
    damping,
    exits,
    pass_through,
    resting,
    touches,
    work,
)
from crashsolve.system.contact.pair import (
    Closing,
    ContactPoint,
    Ends,
    Friction,
    NormalResponse,
    Pair,
    Sliding,
    Totals,
)
from crashsolve.system.loops.approach import ends_of
from crashsolve.system.loops.contact_friction import friction_in_area, friction_in_point
from crashsolve.system.loops.contact_pressure import distribute_pressure, mean_mobility
from crashsolve.system.loops.mobilities import pair_mobility
from crashsolve.system.placeholders import KICK_DRIFT_KICK, THREADS


@kernel
def contact_pairs(group, piece, clock, h, nodes, curves, scene):
    """Forces of the pairs of a group, or of a piece. Writes: totals, outputs, new histories."""
    if group.body_pairs is not None:
        if resting.is_at_end_of_step(h, clock) and scene.control[0].gaps == 1:
            evaluate_deepest(group, clock, nodes, scene)
        for k in range(group.body_pairs.shape[0]):
            both = group.body_pairs[k]
            card = scene.cards[both.card]
            if body_pairs.can_skip_all(both, h, card.depth):
                touches.add_losses(card, both)
                continue
            # a sample changes only columns that the next step writes again
            if h > 0.0:
                body_pairs.end_skipping(both, group.history, group.output)
            evaluated = some_pairs(
                group, piece, both.first, both.end, both.approached, clock, h, nodes, curves, scene
            )
            if h > 0.0 and evaluated == 0:
                body_pairs.begin_skipping(both, clock.current, group.history, group.output)
            elif h == 0.0 and both.skipped == 1:
                body_pairs.bound_by_sample(both, clock.current, group.history, group.output)
    else:
        first, end = ends_of(group, piece, group.parameters.shape[0], scene)
        some_pairs(group, piece, first, end, 0.0, clock, h, nodes, curves, scene)


@apart
def evaluate_deepest(group, clock, nodes, scene):
    """Depth of a pair of each card that may be the deepest, so that a sample looks at few others.

    The pairs of a card follow each other. Writes: cards.depth, output.bound.
    """
    pairs, history, output, k = group.body_pairs, group.history, group.output, 0
    while k < pairs.shape[0]:
        number, bound, at, nearer = pairs[k].card, -1e300, 0, 0.0
        while k < pairs.shape[0] and pairs[k].card == number:
            both = pairs[k]
            if both.skipped == 0 or both.bound + both.approached > bound:
                for i in range(both.first, both.end):
                    depth = history[clock.current, i].depth
                    depth = min(depth, output[i].bound) if both.skipped == 1 else depth
                    depth += both.approached
                    if depth > bound:
                        bound, at, nearer = depth, i, both.approached
            k += 1
        card, p = scene.cards[number], group.parameters[at]
        if bound > card.depth and history[clock.current, at].active == 1:
            # it touches, and as deep but for round-off
            card.depth = max(card.depth, 0.5 * bound)
        elif bound > card.depth:
            a, b = group.elements_a[p.a], group.elements_b[p.b]
            depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
            if nearer > 0.0:
                output[at].bound = body_pairs.known_depth(depth, nearer)
            card.depth = max(card.depth, depth)


@apart
def some_pairs(group, piece, first, end, approached, clock, h, nodes, curves, scene):
    """The same of pairs that follow each other; returns how many gaps were evaluated.

    At a sample, the bodies have approached each other by `approached` since depths were stored [m].
    Writes: totals, outputs, new histories.
    """
    history, output, evaluated = group.history, group.output, 0
    for i in range(first, end):
        p, out = group.parameters[i], output[i]
        old, new = history[clock.current, i], history[1 - clock.current, i]
        a, b = group.elements_a[p.a], group.elements_b[p.b]
        m, w = nodes[a.node], nodes[b.node]
        pair, totals = (
            Pair(p, old, new, out, a, b, m, w),
            sums_of(group, piece, i, clock, p, m, w, scene),
        )
        displacement = 0.0
        if KICK_DRIFT_KICK and (group.skips or group.follows_exit) and h > 0.0:
            displacement = resting.largest_approach(p, m, w)
        if can_skip(group, clock, h, pair, displacement, approached, totals.card):
            continue
        evaluated += 1
        depth, n, x = gap(
            group, h, totals.card, Ends(p, old, new, a, b), displacement, nodes, scene
        )
        if KICK_DRIFT_KICK and group.skips and approached > 0.0:
            out.bound = body_pairs.known_depth(depth, approached)
        depth, n, x, retained = face_of(group, clock, h, pair, depth, n, x, nodes, scene)
        stored = out.stored
        motion = work.motion_over(h, old, depth, m, w, b.node) if KICK_DRIFT_KICK else None
        friction_loss = end_first_half(group, h, old, motion, m, totals.count)
        if group.in_pieces and THREADS:
            touches.mark_applied(group.applied, group.load_rows, i, 1 if depth > 0.0 else 0)
        if depth <= 0.0:
            touches.reset_pair(clock, old, new, out, depth, x)
            released = 0.0
            if group.keeps_faces:
                released = pass_through.released_energy(clock, h, old, n, stored)
            end_contact(group, p, old, new, released, friction_loss)
            touches.add_separated(totals.card, new, n)
            continue
        meeting = ContactPoint(depth, n, x, motion)
        apply_forces(group, clock, h, pair, totals, meeting, nodes, curves, scene)
        if group.keeps_faces and old.retains_face == 1 and not retained:
            # it leaves its own face sideways, deep within
            released = pass_through.released_energy(clock, h, old, n, stored)
            new.dissipated += max(released - out.stored, 0.0)
        touches.add_losses(totals.card, new)
    return evaluated


@stage
def can_skip(group, clock, h, pair, displacement, approached, card):
    """Whether the gap of a pair need not be evaluated. Writes: new, card.

    Its bodies have approached each other by no more than `displacement` in the step; at a sample,
    by `approached` since its depth was stored [m].
    """
    _, old, new, out, _, _, _, _ = pair
    if KICK_DRIFT_KICK and group.skips and h > 0.0 and resting.can_skip(old, new, displacement):
        new.depth = old.depth + displacement
        touches.add_losses(card, new)
        return True
    at_sample = KICK_DRIFT_KICK and group.skips and resting.is_at_end_of_step(h, clock)
    if at_sample and resting.is_below(old, new, out, approached, card.depth):
        new.depth = old.depth  # a step may begin anew here
        touches.add_losses(card, old)
        return True
    return False


@stage
def face_of(group, clock, h, pair, depth, n, x, nodes, scene):
    """Depth, normal and position by the face that a pair keeps; whether it does. Writes: new."""
    p, old, new, _, a, b, m, w = pair
    if group.keeps_faces:
        ends = Ends(p, old, new, a, b)
        return retained_face(group, clock, h, ends, depth, n, x, nodes, scene)
    if group.has_ends:
        pass_through.record_round_pair(clock, h, p, old, new, depth, n, x, m, w)
    return depth, n, x, False


@stage
def sums_of(group, piece, i, clock, p, m, w, scene):
    """The sums to which pair i adds. Of many pairs each has loads, and each piece sums, of its own.

    A single thread adds loads to bodies at once, and needs those of one pair only.
    """
    if group.in_pieces and THREADS:
        on_a, on_b = group.loads[group.load_rows[2 * i]], group.loads[group.load_rows[2 * i + 1]]
        return Totals(on_a, on_b, group.sums[piece], group.counts[piece])
    if group.in_pieces:
        return Totals(group.loads[0], group.loads[1], group.sums[piece], group.counts[piece])
    return Totals(m, w, scene.cards[p.card], scene.card_history[1 - clock.current, p.card])


@stage
def gap(group, h, card, ends, displacement, nodes, scene):
    """Depth, normal and position of a pair. Writes: new.

    For a separated pair whose depth is not needed, only an upper bound of the depth.
    """
    p, old, new, a, b = ends
    if hasattr(group.narrow, "bound") and old.active == 0:
        depth = group.narrow.bound(a, b, nodes, group.data)
        if depth <= resting.skip_depth(h, card.depth):
            return depth, areas.NO_ROTATION, areas.NO_ROTATION
    if KICK_DRIFT_KICK and group.follows_exit:
        new.remaining_lead = exits.remaining_lead(h, old, displacement)
        if new.remaining_lead > 0.0:
            n = exits.carried_normal(h, old, nodes[b.node])
            return group.narrow.follow(a, b, nodes, group.data, n)
        depth, n, x, lead = group.narrow.search(a, b, nodes, group.data)
        new.remaining_lead = exits.trusted_lead(p, lead)
        return depth, n, x
    return group.narrow.gap(a, b, nodes, group.data)


@stage
def retained_face(group, clock, h, ends, depth, n, x, nodes, scene):
    """Depth, normal and position of a pair by the face that it keeps, and whether that continues.

    Writes: new.
    """
    p, old, new, a, b = ends
    retained, over = False, -1.0
    if pass_through.is_another_face(old, depth, n, a.radius):
        v_a = pass_through.velocity_at(nodes[a.node], x)
        v_b = pass_through.velocity_at(nodes[b.node], x)
        kept = group.narrow.gap_by(a, b, nodes, group.data, old.normal)
        if pass_through.may_retain_face(old, v_a, v_b, n, kept):
            retained = True
            depth, n, x, over = kept
    if group.has_core_depth and depth > a.radius:
        over = max(over, depth - group.narrow.middle(a, b, nodes, n))
    pass_through.record_face(clock, h, p, old, new, retained, over, depth, n)
    pass_through.record_side(old, new, nodes[a.node], nodes[b.node], n, x)
    return depth, n, x, retained


@stage
def end_first_half(group, h, old, motion, m, count):
    """Loss by friction in the half of a step in which the last forces end [J]. Writes: count."""
    if KICK_DRIFT_KICK and group.resists_spin:
        return areas.add_first_half_work(h, old, motion, m, count)
    if KICK_DRIFT_KICK and group.friction:
        return work.add_first_half_work(h, old, motion, m, count)
    if KICK_DRIFT_KICK:
        work.add_start_work(h, old, motion, m, count)
    return 0.0


@stage
def end_contact(group, p, old, new, released, friction_loss):
    """The laws of a pair that is apart; `released` by a face that it kept [J]. Writes: new."""
    group.normal.release(p, old, new)
    if group.keeps_faces:
        new.dissipated += released
    if group.friction:
        group.friction.release(p, old, new)
    if group.friction and KICK_DRIFT_KICK:
        work.end_friction(old, new, friction_loss)


@stage
def apply_forces(group, clock, h, pair, totals, meeting, nodes, curves, scene):
    """Forces of one pair in contact, also of many. Writes: totals, output, new history, nodes."""
    if group.in_pieces:
        touches.clear_load(totals.on_a)
        touches.clear_load(totals.on_b)
    apply_pair_forces(group, clock, h, pair, totals, meeting, nodes, curves, scene)
    if group.in_pieces and not THREADS:
        touches.add_load(pair.a, totals.on_a)
        touches.add_load(pair.b, totals.on_b)


@stage
def apply_pair_forces(group, clock, h, pair, totals, meeting, nodes, curves, scene):
    """Forces of one pair in contact. Writes: totals, output, new history."""
    p, old, new, out, _, _, m, w = pair
    card, count = totals.card, totals.count
    depth, n, x, motion = meeting
    rate, slip, d_a, d_b = touches.closing_motion(m, w, x, n)
    touches.latch(p, old, new, depth, rate, count)
    if group.has_ends and not group.keeps_faces:
        count.peak_share = max(count.peak_share, depth / p.thick)
    mobility = pair_mobility(m, w, d_a, d_b, n)
    mass = 1.0 / (mobility[0] + mobility[1])
    corners, radius = patch_of(group, pair, meeting, nodes, scene)
    applied = fraction_of_step(clock, h, old, depth, rate)
    closing = Closing(rate, mass, mobility, applied, corners)
    f, power, loss, x = normal_force_of(group, h, pair, totals, meeting, closing, curves, scene)
    closing_rate = rate
    if group.is_flat:
        closing_rate, slip, d_a, d_b = touches.closing_motion(m, w, x, n)
    displacement = work.displacement_to(motion, m, x) if KICK_DRIFT_KICK else None
    if KICK_DRIFT_KICK and group.loses_work and h > 0.0:
        power, loss = 0.0, work_lost(group, pair, meeting, applied * f, displacement)
    sliding = Sliding(n, slip, displacement, f, mass, d_a, d_b)
    friction = friction_of(group, clock, h, pair, totals, sliding, motion, radius, curves)
    if group.is_flat:
        touches.apply_contact_force(pair, totals, sliding, applied, 0.0, friction.t, x)
        areas.add_pressure(f, n, out)
    else:
        touches.apply_contact_force(pair, totals, sliding, applied, f, friction.t, x)
    if group.resists_spin:
        areas.twist(totals.on_a, totals.on_b, friction.force, n, radius, applied)
    touches.add_dissipation(clock, old, new, applied, power, loss, friction.power, friction.loss)
    touches.add_to_card(card, count, p.order, applied, f, friction.t, new, out)
    if KICK_DRIFT_KICK:
        begin_second_half(group, applied, pair, sliding, x, friction, radius, count)
    else:
        touches.record_power(applied, f, closing_rate, friction.t, slip, out, count)


@stage
def normal_force_of(group, h, pair, totals, meeting, closing, curves, scene):
    """Normal force [N], its power [W] and loss [J], and position.

    Writes: out.stored, new, totals.
    """
    depth, n, x, _ = meeting
    rate, mass, mobility, applied, corners = closing
    out, weight = pair.out, 0.0
    if group.is_flat:
        mobility = mean_mobility(pair, group.data[0], corners, n)
    if KICK_DRIFT_KICK and group.resolves_damping:
        rate, weight = implicit_rate(group, h, pair, totals, meeting, closing, mobility)
    f, out.stored, power, loss, k, c = group.normal.normal_force(
        pair.p, pair.old, pair.new, h, depth, rate, mass, curves
    )
    if KICK_DRIFT_KICK and group.resolves_damping:
        k, c = group.normal.resolved_slopes(pair.p, pair.new, rate, mass, out.stored, k, c)
    if group.has_shares:
        # the law returns the force of the full surface, of which this is one element
        share = pair.first.share
        f, out.stored, power = share * f, share * out.stored, share * power
        loss, k, c = share * loss, share * k, share * c
    touches.add_pair_stiffness(totals.on_a, totals.on_b, mobility[0], mobility[1], k, c)
    if group.is_flat:
        _, c_now = group.normal.normal_tangent(pair.p, pair.new, depth, rate, mass, curves)
        push = NormalResponse(f, rate, c_now, weight)
        f, more, x = distribute_pressure(group, pair, totals, corners, n, x, applied, push, scene)
        power += more
    return f, power, loss, x


@stage
def implicit_rate(group, h, pair, totals, meeting, closing, mobility):
    """Closing speed of the normal force [m/s], and the weight of the speed that it leads to.

    Writes: totals, new.
    """
    p, old, new, depth = pair.p, pair.old, pair.new, meeting.depth
    c = group.normal.rate_slope(p, old, new, h, depth, closing.mass)
    if c <= 0.0:
        return closing.rate, 0.0
    share = pair.first.share if group.has_shares else 1.0
    weight = damping.add_dampers(h, pair, totals, share * c * mobility[0], share * c * mobility[1])
    if weight == 0.0:
        return closing.rate, 0.0
    if group.is_flat:
        before = old.even_force if old.active == 1 else 0.0
    else:
        before = damping.force_before(old, meeting.n) / share
    free = closing.rate + weight / c * before
    return group.normal.implicit_rate(p, c, depth, free, weight / c), weight


@stage
def friction_of(group, clock, h, pair, totals, sliding, motion, radius, curves):
    """Friction of the pair. Writes: out, new."""
    pair.out.friction_stored = 0.0
    if group.resists_spin:
        force, displacement, power, loss = friction_in_area(
            group, clock, h, pair, totals, sliding, motion, radius, curves
        )
        return Friction(areas.along_surface(force, sliding.n), force, displacement, power, loss)
    if group.friction:
        t, power, loss = friction_in_point(group, clock, h, pair, totals, sliding, curves)
        return Friction(t, None, None, power, loss)
    return Friction((0.0, 0.0, 0.0), None, None, 0.0, 0.0)


@stage
def begin_second_half(group, applied, pair, sliding, x, friction, radius, count):
    """Store the forces with which the second half of a step begins. Writes: out, new, count."""
    if group.resists_spin:
        areas.add_second_half_work(
            applied, pair, sliding, x, friction.force, friction.displacement, radius, count
        )
    elif group.friction:
        work.add_second_half_work(applied, pair, sliding, x, friction.t, count)
    else:
        work.add_end_work(
            applied, sliding.displacement, sliding.f, sliding.n, x, pair.out, pair.new, count
        )


@stage
def work_lost(group, pair, meeting, push, displacement):
    """Work done on a pair over a step that it does not hold [J]."""
    growth = pair.new.recoverable - pair.old.recoverable
    if group.has_shares:
        growth *= pair.first.share
    done = work.normal_work(pair.old, meeting.motion, pair.a, push, meeting.n, displacement)
    return -done - growth


@stage
def patch_of(group, pair, meeting, nodes, scene):
    """Corners of the area over which the sides press, and the radius of friction's spin [m]."""
    count, radius = 0, 0.0
    if group.is_flat:
        count, radius = group.narrow.patch(
            pair.first, pair.second, nodes, group.data, meeting.n, meeting.x
        )
    if group.has_radius:
        radius = max(radius, pair.p.torsion_radius)
    return count, radius


@stage
def fraction_of_step(clock, h, old, depth, rate):
    """Fraction of the force of a pair in the step in which it begins to touch."""
    if KICK_DRIFT_KICK:
        return touches.applied_fraction(old, depth, rate, h)
    return touches.onset_factor(clock, old, h)
