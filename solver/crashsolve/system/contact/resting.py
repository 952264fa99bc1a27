"""Pairs that are skipped until they may have met.

    depth <= depth_before + |dr_a - dr_b - tau_b x (r_a - r_b)| + |tau_a - tau_b| R_a
                          + tau_a^2 R_a + tau_b^2 (R_a + |r_a - r_b|)

in a step that moves the mass centres by dr and turns the bodies by theta, tau = 2 tan(theta / 2)
along the axis of rotation, R how far an element reaches from the mass centre of its body: seen from
body b, no point of a moves farther. The first line is exact for small rotations; R v - v differs
from tau x v by tau^2 |v| at most. Body b is the one whose element reaches farther, so that a body
carried along in a fast vehicle stays apart from its walls. As long as that bound is negative no gap
is computed, and the history of the pair does not change; at samples no gap is computed that the
bound keeps below the deepest of the card. Consequence to test: the same results as without.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import cross, dot, norm, put, scale, sub, vec
from crashsolve.system.points import half_rotation

# steps like this one that must still be free: the gap must be known when the step that closes it
# begins
STEPS_AHEAD = 4.0


@kernel
def record_motion(nodes):
    """Record displacement and rotation of bodies since the start of the step. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if b.has_surface == 1:
            put(b.moved, sub(vec(b.r), vec(b.start_r)))
            put(b.rotated, scale(2.0, half_rotation(b.start_q, b.q)))


@kernel
def largest_approach(p, a, b):
    """Largest decrease of the gap of a pair on bodies a and b in the step [m]."""
    if p.reach_a <= p.reach_b:
        return relative_motion_bound(a, b, p.reach_a)
    return relative_motion_bound(b, a, p.reach_b)


@kernel
def relative_motion_bound(a, b, reach):
    """Bounds of displacement [m] of points within `reach` of the mass centres of bodies a and b."""
    offset, of_a, of_b = sub(vec(a.r), vec(b.r)), vec(a.rotated), vec(b.rotated)
    travel = sub(sub(vec(a.moved), vec(b.moved)), cross(of_b, offset))
    curved = dot(of_a, of_a) * reach + dot(of_b, of_b) * (reach + norm(offset))
    return norm(travel) + norm(sub(of_a, of_b)) * reach + curved


@kernel
def skip_depth(h, deepest):
    """Depth below which a separated pair is skipped [m]: at samples, the deepest."""
    return min(0.0, deepest) if h == 0.0 else 0.0


@kernel
def is_at_end_of_step(h, clock):
    """Whether this is a sample at the end of the last step, as the histories of pairs are."""
    return h == 0.0 and clock.kicked_over > 0.0


@kernel
def least_depth(h, clock, control):
    """Depth below which none is needed [m]: that of touching where a sample needs no gaps."""
    return 0.0 if is_at_end_of_step(h, clock) and control.gaps == 0 else -1e300


@kernel
def can_skip(old, new, displacement):
    """Whether a pair whose gap changes by at most `displacement` in a step is surely separated and
    skipped.

    Both histories are those of a separated pair, so only the depth has to be written.
    """
    if old.active == 1 or new.active == 1:
        return False
    return old.depth + (1.0 + STEPS_AHEAD) * displacement <= 0.0


@kernel
def is_below(old, new, out, approached, deepest):
    """Whether a pair whose bodies have approached each other by `approached` since its depth was
    computed is separated, and not deeper than the deepest of its card so far [m].

    Such a pair is skipped at a sample.
    """
    if old.active == 1 or new.active == 1:
        return False
    return min(old.depth, out.bound) + approached <= min(0.0, deepest)
