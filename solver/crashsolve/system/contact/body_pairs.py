"""Pairs of elements on the same two bodies, which are skipped together while all are separated.

    depth <= depth_before + approached,   approached = sum over steps of the largest approach of
    both bodies

The bound of resting.py for the elements farthest from the mass centres. While it is negative by
STEPS_AHEAD steps all of the pairs are skipped: their depths are kept from the last evaluation, and
updated when skipping ends. Consequence to test: the same bits as without.

A sample needs the depth of the deepest pair of a card, also of separated ones. Depths that it
evaluates bound those of later samples (`bound`), and of nothing else: steps do not depend on
samples.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, sub, vec
from crashsolve.system.contact import resting

ROUND_OFF = 1e-14


@kernel
def can_skip_all(both, h, deepest):
    """Whether all pairs of two bodies are skipped in this step, as none can have met; are_below has
    found their approach.

    At a sample those below the `deepest` of their card [m] are skipped. Writes: both.approached.
    """
    if both.skipped == 0:
        return False
    approach = both.approach if h > 0.0 else 0.0
    known = both.bound if h == 0.0 else both.depth
    ahead = known + both.approached + (1.0 + resting.STEPS_AHEAD) * approach
    if ahead > resting.skip_depth(h, deepest):
        return False
    both.approached += approach
    return True


@kernel
def are_below(both, limit, nodes):
    """Whether no pair of two skipped bodies is deeper than `limit` [m] after the trial step.

    Writes: both.approach.
    """
    if both.skipped == 0:
        return False
    both.approach = resting.largest_approach(both, nodes[both.node_a], nodes[both.node_b])
    return both.depth + both.approached + both.approach <= limit


@kernel
def closing_speed_bound(both, nodes):
    """Upper bound of the closing speed of any two elements of two bodies [m/s]."""
    a, b = nodes[both.node_a], nodes[both.node_b]
    spin = norm(vec(a.w)) * both.reach_a + norm(vec(b.w)) * both.reach_b
    return norm(sub(vec(a.v), vec(b.v))) + spin


@kernel
def begin_skipping(both, current, history, output):
    """Begin to skip these pairs, all separated in the step that ends.

    Writes: both, history.depth, output.bound.
    """
    both.skipped, both.approached, both.depth = 1, 0.0, -1e300
    both.changes += 1
    both.dissipated = both.friction_dissipated = 0.0
    for i in range(both.first, both.end):
        old, new = history[current, i], history[1 - current, i]
        # either of the two is the present one in a later step
        old.depth = output[i].bound = new.depth
        both.depth = max(both.depth, new.depth)
        both.dissipated += new.dissipated
        both.friction_dissipated += new.friction_dissipated
    both.bound = both.depth


@kernel
def has_energy(both):
    """Whether these pairs may hold energy, or have lost some."""
    return both.skipped == 0 or both.dissipated != 0.0 or both.friction_dissipated != 0.0


@kernel
def known_depth(depth, approached):
    """Bound by a depth [m] that a sample has evaluated, of a pair that is skipped.

    Less by round-off, so that this sample does not evaluate it again.
    """
    return min(depth - approached - ROUND_OFF * (approached - depth), 0.0)


@kernel
def bound_by_sample(both, current, history, output):
    """Bound the depths of skipped pairs by those that a sample has evaluated. Writes: both."""
    both.bound = -1e300
    both.changes += 1
    for i in range(both.first, both.end):
        both.bound = max(both.bound, min(history[current, i].depth, output[i].bound))


@kernel
def end_skipping(both, history, output):
    """End skipping: each pair is evaluated by itself from now on.

    Writes: both, history.depth, output.bound.
    """
    if both.skipped == 1:
        for i in range(both.first, both.end):
            history[0, i].depth += both.approached
            history[1, i].depth += both.approached
            output[i].bound = 0.0
        both.skipped, both.approached = 0, 0.0
