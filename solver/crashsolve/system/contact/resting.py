"""Pairs that are left alone until they may have met.

    depth <= depth_before + |dr_a| + |dr_b| + theta_a R_a + theta_b R_b

in a step that moves the mass centres by dr and turns the bodies by theta, R how far an element
reaches from the mass centre of its body: two that are apart come together no faster than their
points move. As long as that bound is below every depth that matters, no gap is looked for, and what
a pair remembers stays as it is. Consequence to test: the same results as without.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import norm, sub, vec
from crashsolve.system.points import half_rotation

# steps like this one that must still be free: a gap is known when the step that closes it begins
AHEAD = 4.0


@kernel
def note_motion(nodes):
    """How far every body has moved and turned since the start of the step. Writes: nodes."""
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        b.moved = norm(sub(vec(b.r), vec(b.start_r)))
        # 2 tan(theta / 2) is not below theta
        b.rotated = 2.0 * norm(half_rotation(b.start_q, b.q))


@kernel
def largest_approach(p, a, b):
    """What the gap of a pair on bodies a and b has lost in the step at most [m]."""
    return a.moved + b.moved + a.rotated * p.reach_a + b.rotated * p.reach_b


@kernel
def rests(h, old, new, displacement, deepest):
    """Whether a pair that has gone `displacement` is apart, and nothing is asked about its gap.

    Both histories are those of a pair apart, so but for the depth there is nothing to write.
    """
    if h == 0.0 or old.active == 1 or new.active == 1:
        return False
    return old.depth + (1.0 + AHEAD) * displacement <= min(0.0, deepest)
