"""What begins within a step: onsets of contact, branches of laws, lists of pairs to renew."""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.system.contact import (
    areas,
    body_pairs,
    node_contact,
    passing,
    projection,
    touches,
)
from crashsolve.system.loops.approach import depth_before, gaps_of
from crashsolve.system.loops.many_pairs import before_of_pieces
from crashsolve.system.loops.pieces import approach_in_pieces
from crashsolve.system.placeholders import BRANCHED, BRANCHES, CONTACTS, NODAL


@kernel
def approach(clock, nodes, scene, floor):
    """Largest depth of pairs that did not touch at the start of the step [m]; negative is a gap.

    Where ends of contacts are located too: and largest gap of those that did touch. A depth not
    above `floor` need not be known.
    """
    deepest = -1e300
    for group in CONTACTS:
        if group.in_pieces:
            deepest = approach_in_pieces(group, clock, floor, deepest, scene)
        else:
            deepest = gaps_of(group, 0, clock.current, nodes, floor, deepest, scene)
    return deepest


@kernel
def approach_before(clock, scene):
    """The largest depth at the start of the step [m], of pairs that did not touch."""
    deepest = -1e300
    for group in CONTACTS:
        if group.in_pieces:
            deepest = before_of_pieces(group, deepest, scene)
        else:
            deepest = depth_before(group, 0, clock.current, deepest, scene)
    return min(deepest, 0.0)


@kernel
def event(current, h, nodes, curves, scene):
    """Largest distance of laws beyond the branches on which a step of h began [m or rad]; 0: not
    yet.
    """
    farthest = -1e300
    for group in BRANCHES:
        p, history = group.parameters, group.history
        for i in range(p.shape[0]):
            past = group.law.event(p[i], history[current, i], h, nodes, curves)
            farthest = max(farthest, past)
    for pairs in BRANCHED:
        farthest = max(farthest, farthest_pair(pairs, current, h, nodes, curves, scene))
    return farthest


@stage
def farthest_pair(pairs, current, h, nodes, curves, scene):
    """The same of the pairs that touch: branches of a normal force are ranges of depth and closing
    speed, those of friction ranges of the slip speed.
    """
    params, history, farthest = pairs.parameters, pairs.history, -1e300
    for i in range(params.shape[0]):
        p, old = params[i], history[current, i]
        if old.active == 1:
            a, b = pairs.elements_a[p.a], pairs.elements_b[p.b]
            depth, n, x = gap_of(pairs, a, b, old, nodes, scene)
            if hasattr(pairs.normal, "branch_left"):
                rate, _, _, _ = touches.closing_motion(nodes[a.node], nodes[b.node], x, n)
                past = pairs.normal.branch_left(p, old, h, depth, rate, curves)
                farthest = max(farthest, past)
            if hasattr(pairs.friction, "regime_left") and depth > 0.0:
                slip = slip_of(pairs, p, n, x, nodes, scene)
                past = h * pairs.friction.regime_left(p, old, slip)  # type: ignore[union-attr]
                farthest = max(farthest, past)
    return farthest


@stage
def slip_of(pairs, p, n, x, nodes, scene):
    """Slip velocity of a pair [m/s], including that of a spin that friction resists."""
    a, b = pairs.elements_a[p.a], pairs.elements_b[p.b]
    m, w = nodes[a.node], nodes[b.node]
    _, slip, _, _ = touches.closing_motion(m, w, x, n)
    if not pairs.resists_spin:
        return slip
    radius = 0.0
    if pairs.is_flat:
        _, radius = pairs.narrow.patch(a, b, nodes, pairs.data, n, x)
    if pairs.has_radius:
        radius = max(radius, p.torsion_radius)
    return areas.combined_slip(m, w, slip, n, radius)


@stage
def gap_of(pairs, a, b, old, nodes, scene):
    """Depth, normal and point of a pair that touched when the step began."""
    depth, n, x = pairs.narrow.gap(a, b, nodes, pairs.data)
    if pairs.keeps_faces and old.retains_face == 1:
        depth, n, x, _ = pairs.narrow.gap_by(a, b, nodes, pairs.data, old.normal)
    return depth, n, x


@kernel
def need_rebuild(clock, nodes, scene):
    """Whether the next step might touch a pair that is not in the list. Writes: clock.next_step."""
    stale = False
    for probes in NODAL:
        node_contact.limit_closing(clock, probes.p[0], probes.totals[0])
        if probes.narrow is None:
            stale |= projection.needs_room(probes.p[0], probes.totals[0])
    for group in CONTACTS:
        if group.search is not None:
            stale |= touches.needs_new_list(
                clock, group.elements_a, nodes, group.reference_a, group.slack[0]
            )
            stale |= touches.needs_new_list(
                clock, group.elements_b, nodes, group.reference_b, group.slack[0]
            )
        elif group.bounds_next_step:
            limit_closing(group, clock, nodes, scene)
    return stale


@stage
def limit_closing(group, clock, nodes, scene):
    """Cut the next step so that no two sides pass through or by each other between two searches.

    A step brings them at most a share of their thickness nearer than touching.
    Writes: clock.next_step.
    """
    if group.body_pairs is not None:
        for k in range(group.body_pairs.shape[0]):
            both = group.body_pairs[k]
            at_most = body_pairs.closing_speed_bound(both, nodes)
            distance = touches.LARGEST_CLOSING * both.thick - both.depth - both.approached
            if both.skipped == 0 or at_most * clock.next_step > distance:
                body_pairs.end_skipping(both, group.history, group.output)
                limit_some(group, both.first, both.end, at_most, clock, nodes, scene)
    else:
        limit_some(group, 0, group.parameters.shape[0], 1e300, clock, nodes, scene)


@stage
def limit_some(group, first, end, at_most, clock, nodes, scene):
    """The same for some pairs, none of which closes faster than `at_most` [m/s].

    Writes: clock.next_step.
    """
    params, history = group.parameters, group.history
    for i in range(first, end):
        p, now = params[i], history[clock.current, i]
        if now.active == 1:
            continue
        distance = touches.LARGEST_CLOSING * p.thick - now.depth
        # that is enough for most, and costs little
        if at_most * clock.next_step <= distance:
            continue
        a, b = group.elements_a[p.a], group.elements_b[p.b]
        speed = touches.closing_speed_bound(p, a, b, nodes)
        if group.skips and speed * clock.next_step > distance:
            # the stored value is only a bound
            depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
            distance = touches.LARGEST_CLOSING * p.thick - depth
        if speed * clock.next_step > distance:
            clock.next_step = distance / speed


@kernel
def may_pass(located, h, clock, nodes, scene):
    """Whether forces of a step of h bring two sides so near that one may have passed the other.

    `located`: trials of a step that ends at an onset. The step that these shorten has been checked.
    """
    control = scene.control[0]
    if located > 0 or h <= control.step_min:
        return False
    if not passing.is_accelerated(nodes, h, control.length, control.thinnest):
        return False
    passes = False
    for group in CONTACTS:
        if group.search is not None:
            passes |= passing.leaves_list(
                group.elements_a, nodes, group.reference_a, group.slack[0]
            )
            passes |= passing.leaves_list(
                group.elements_b, nodes, group.reference_b, group.slack[0]
            )
        elif group.bounds_next_step:
            passes |= close_too_far(group, clock.current, nodes, scene)
    return passes


@stage
def close_too_far(group, current, nodes, scene):
    """Whether two sides of a group approach by more than their gap and a share of both."""
    passes = False
    if group.body_pairs is not None:
        for k in range(group.body_pairs.shape[0]):
            both = group.body_pairs[k]
            # of skipped pairs the depth is that before they were
            approached = both.approached if both.skipped == 1 else 0.0
            passes |= some_close_too_far(
                group, both.first, both.end, approached, current, nodes, scene
            )
    else:
        passes |= some_close_too_far(
            group, 0, group.parameters.shape[0], 0.0, current, nodes, scene
        )
    return passes


@stage
def some_close_too_far(group, first, end, approached, current, nodes, scene):
    """The same for some pairs, which have come nearer by `approached` [m] than is stored."""
    params, history = group.parameters, group.history
    for i in range(first, end):
        p, now = params[i], history[current, i]
        if now.active == 0:
            a, b = group.elements_a[p.a], group.elements_b[p.b]
            nearer = passing.closing_distance_bound(p, a, b, nodes[a.node], nodes[b.node])
            if nearer > passing.SHARE * p.thick - now.depth - approached:
                return True
    return False
