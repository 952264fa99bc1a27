"""Unilateral constraints: impulses on nodes in contact, in both halves of a step.

See system/contact/unilateral.py.
"""

from crashsolve.foundation.kernels import kernel, stage
from crashsolve.model.clock import UNHELD
from crashsolve.system.contact import times, unilateral
from crashsolve.system.contact.pair import ContactPoint, Pair
from crashsolve.system.placeholders import UNILATERAL


@kernel
def find_touching(group, clock, h, nodes, scene):
    """Find the touching pairs of one group, and their points. Writes: new histories, outputs."""
    params, history, output = group.parameters, group.history, group.output
    for i in range(params.shape[0]):
        old, new = history[clock.current, i], history[1 - clock.current, i]
        a, b = group.elements_a[params[i].a], group.elements_b[params[i].b]
        depth, n, x = group.narrow.gap(a, b, nodes, group.data)
        m, w = nodes[a.node], nodes[b.node]
        pair = Pair(params[i], old, new, output[i], a, b, m, w)
        unilateral.update_pair(clock, h, pair, ContactPoint(depth, n, x, None))


@stage
def sweep(is_half, is_impulse, clock, nodes, scene):
    """Sweeps over the pairs of all groups until their impulses agree. Writes: histories, nodes."""
    for _ in range(unilateral.SWEEPS):
        change, most = 0.0, 0.0
        for group in UNILATERAL:
            sides = (group.elements_a, group.elements_b)
            pairs = unilateral.Pairs(group.parameters, group.history, group.output, sides)
            change, most = unilateral.sweep(
                is_half, is_impulse, clock.current, pairs, nodes, change, most
            )
        if change <= unilateral.CONVERGED * most:
            break


@kernel
def impulses_of_first_half(h, clock, control, nodes, scene):
    """Impulses in the first half of a step on active pairs. Writes: nodes, new histories."""
    for group in UNILATERAL:
        unilateral.clear_impulses(clock.current, group.history)
    worst = 0.0
    for _ in range(unilateral.MAX_ITERATIONS):
        sweep(True, False, clock, nodes, scene)
        worst = 0.0
        for group in UNILATERAL:
            params, history = group.parameters, group.history
            sides = (group.elements_a, group.elements_b)
            unilateral.drift_active_pairs(clock.current, h, params, history, sides, nodes)
            for i in range(params.shape[0]):
                old, new = history[clock.current, i], history[1 - clock.current, i]
                if old.active == 1:
                    a, b = group.elements_a[params[i].a], group.elements_b[params[i].b]
                    depth, _, _ = group.narrow.gap(a, b, nodes, group.data)
                    worst = max(worst, unilateral.correct_lift(old, new, depth, h))
        if worst <= unilateral.LARGEST_GAP * control.length:
            break
    if not worst <= unilateral.LARGEST_GAP * control.length:
        clock.status, clock.value = UNHELD, worst
    for group in UNILATERAL:
        sides = (group.elements_a, group.elements_b)
        unilateral.add_friction_loss(clock.current, group.parameters, group.history, sides, nodes)


@kernel
def impulses_of_second_half(h, clock, nodes, scene):
    """Impulses in the second half, and on new pairs. Writes: nodes, new histories."""
    if h > 0.0:
        sweep(False, False, clock, nodes, scene)
        fresh = 0
        for group in UNILATERAL:
            params, history = group.parameters, group.history
            sides = (group.elements_a, group.elements_b)
            fresh += unilateral.record_reactions(h, clock.current, params, history, sides, nodes)
        if fresh > 0:
            sweep(False, True, clock, nodes, scene)
        for group in UNILATERAL:
            params, history = group.parameters, group.history
            sides = (group.elements_a, group.elements_b)
            unilateral.record_impulses(
                clock.current, params, history, sides, nodes, scene.card_history
            )
    for group in UNILATERAL:
        sides = (group.elements_a, group.elements_b)
        pairs = unilateral.Pairs(group.parameters, group.history, group.output, sides)
        unilateral.finish_pairs(h, clock, pairs, nodes, scene.cards, scene.card_history)
    time = clock.time + h
    times.time_cards(time, h, clock, scene.cards, scene.card_history)
