"""Pairs of elements on the same two bodies, which rest together while all of them are apart.

    depth <= depth_before + gone,   gone = sum over steps of the largest approach of both bodies

The bound of resting.py for the elements that reach farthest. While it is negative by AHEAD steps
none of the pairs is looked at: their depths stay as they were when this rest began, and are brought
up to date when it ends. Consequence to test: the same bits as without.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, sub, vec
from crashsolve.system.contact import resting


@kernel
def stay_apart(both, h, deepest, nodes):
    """Whether nothing is asked of the pairs of two bodies in this step, none of which can have met.

    Of a sample nothing is asked of those below the `deepest` of their card [m]. Writes: both.gone.
    """
    if both.rests == 0:
        return False
    approach = 0.0
    if h > 0.0:
        approach = resting.largest_approach(both, nodes[both.node_a], nodes[both.node_b])
    ahead = both.depth + both.gone + (1.0 + resting.AHEAD) * approach
    if ahead > resting.unasked_depth(h, deepest):
        return False
    both.gone += approach
    return True


@kernel
def are_below(both, limit, nodes):
    """Whether no pair of two bodies at rest is deeper than `limit` [m] after the step tried."""
    if both.rests == 0:
        return False
    approach = resting.largest_approach(both, nodes[both.node_a], nodes[both.node_b])
    return both.depth + both.gone + approach <= limit


@kernel
def closing_at_most(both, nodes):
    """Upper bound of the closing speed of any two elements of two bodies [m/s]."""
    a, b = nodes[both.node_a], nodes[both.node_b]
    spin = norm(vec(a.w)) * both.reach_a + norm(vec(b.w)) * both.reach_b
    return norm(sub(vec(a.v), vec(b.v))) + spin


@kernel
def begin_rest(both, current, history):
    """None of these pairs was looked at in a step that ends. Writes: both, history.depth."""
    both.rests, both.gone, both.depth = 1, 0.0, -1e300
    both.dissipated = both.friction_dissipated = 0.0
    for i in range(both.first, both.end):
        old, new = history[current, i], history[1 - current, i]
        # either of the two is the present one in a later step
        old.depth = new.depth
        both.depth = max(both.depth, new.depth)
        both.dissipated += new.dissipated
        both.friction_dissipated += new.friction_dissipated


@kernel
def end_rest(both, history):
    """Each pair is looked at by itself from now on. Writes: both, history.depth."""
    if both.rests == 1:
        for i in range(both.first, both.end):
            history[0, i].depth += both.gone
            history[1, i].depth += both.gone
        both.rests, both.gone = 0, 0.0
