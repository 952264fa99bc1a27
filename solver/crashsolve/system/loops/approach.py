"""How near the pairs of a contact group are at the end of a step, and were at its start."""

from crashsolve.foundation.kernels import apart, stage
from crashsolve.system.contact import body_pairs, resting
from crashsolve.system.placeholders import KICK_DRIFT_KICK


@stage
def ends_of(group, piece, count, scene):
    """First pair, and first one after them, of all `count` pairs of a group, or of a piece."""
    if group.in_pieces:
        return group.pieces[piece].first, group.pieces[piece].end
    return 0, count


@stage
def gaps_of(group, piece, current, nodes, floor, deepest, scene):
    """The largest depth of the pairs of a group, or of a piece of it, and of another [m].

    Of pairs that did not touch at the start of the step; see approach in events.py. Writes:
    body_pairs.
    """
    if group.body_pairs is not None:
        for k in range(group.body_pairs.shape[0]):
            both = group.body_pairs[k]
            if not body_pairs.are_below(both, max(deepest, floor), nodes):
                body_pairs.end_skipping(both, group.history, group.output)
                deepest = gaps_of_some(
                    group, both.first, both.end, current, nodes, floor, deepest, scene
                )
        return deepest
    first, end = ends_of(group, piece, group.parameters.shape[0], scene)
    return gaps_of_some(group, first, end, current, nodes, floor, deepest, scene)


@apart
def gaps_of_some(group, first, end, current, nodes, floor, deepest, scene):
    """The same of some pairs that follow each other [m]."""
    params, history = group.parameters, group.history
    for i in range(first, end):
        if not KICK_DRIFT_KICK:
            # a method of high order is affected by the kink at the end of a contact too
            a, b = group.elements_a[params[i].a], group.elements_b[params[i].b]
            depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
            deepest = max(deepest, depth if history[current, i].active == 0 else -depth)
        elif history[current, i].active == 0:
            a, b = group.elements_a[params[i].a], group.elements_b[params[i].b]
            if group.skips:
                displacement = resting.largest_approach(params[i], nodes[a.node], nodes[b.node])
                if history[current, i].depth + displacement <= max(deepest, floor):
                    continue
            if hasattr(group.narrow, "bound"):
                if group.narrow.bound(a, b, nodes, group.data) > max(deepest, floor):
                    depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
                    deepest = max(deepest, depth)
            else:
                depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
                deepest = max(deepest, depth)
    return deepest


@stage
def depth_before(group, piece, current, deepest, scene):
    """The largest depth at the start of the step, of pairs that may meet in it [m]."""
    if group.body_pairs is not None:
        for k in range(group.body_pairs.shape[0]):
            both = group.body_pairs[k]
            if both.skipped == 0:
                deepest = depth_of_some(group, both.first, both.end, current, deepest, scene)
        return deepest
    first, end = ends_of(group, piece, group.history.shape[1], scene)
    return depth_of_some(group, first, end, current, deepest, scene)


@stage
def depth_of_some(group, first, end, current, deepest, scene):
    """The largest depth of some pairs that follow each other [m]."""
    history = group.history
    for i in range(first, end):
        depth = history[current, i].depth
        if not KICK_DRIFT_KICK:
            deepest = max(deepest, depth if history[current, i].active == 0 else -depth)
        elif history[current, i].active == 0:
            deepest = max(deepest, depth)
    return deepest
