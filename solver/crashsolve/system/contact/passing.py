"""How far forces bring two sides within a step: one must not pass through the other unseen.

    approach <= |d_a - d_b| + c_a R_a + c_b R_b

d the displacement of the middle of an element, c = 2 sin(theta / 2) the chord of the rotation of
its body and R its extent. A step is cut beforehand by the velocities with which it begins
(loops/events.py). A body that is accelerated within it, from rest and under a load that has just
begun, moves farther: where the approach exceeds the gap and SHARE of the half thickness of both
sides, the step is halved. Consequence to test: what is pushed from rest meets what it passes
through in one long step.
"""

from math import sqrt

from crashsolve.foundation.columns import matvec
from crashsolve.foundation.kernels import inlined, kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.vec3 import add, norm, scale, sub, vec

# of the half thickness of both sides: the middle of neither is reached
SHARE = 0.5
# of the least of them: forces that displace no body farther bring no pair too near
NEGLIGIBLE = 0.1


@kernel
def is_accelerated(nodes, h, length, thinnest):
    """Whether forces of a step of h displace a body by a share of the thinnest sides [m].

    `length`: the model's size, beyond the extent of any element.
    """
    for i in range(1, nodes.shape[0]):
        b = nodes[i]
        if b.has_surface == 1:
            moved = norm(sub(sub(vec(b.r), vec(b.start_r)), scale(h, vec(b.start_v))))
            rotated = max(0.0, chord(b) - h * norm(matvec(b.W, vec(b.start_L))))
            if moved + rotated * length > NEGLIGIBLE * thinnest:
                return True
    return False


@kernel
def closing_distance_bound(p, element_a, element_b, a, b):
    """Largest decrease of the gap of two elements on bodies a and b in the step [m]."""
    d_a, d_b = displacement(a, vec(element_a.point)), displacement(b, vec(element_b.point))
    return norm(sub(d_a, d_b)) + chord(a) * p.spread_a + chord(b) * p.spread_b


@inlined
def displacement(b, point):
    """Displacement [m] of a point of a body, given in its axes, since the start of the step."""
    return sub(world_position(b, point), add(vec(b.start_r), matvec(b.start_A, point)))


@kernel
def chord(b):
    """2 sin(theta / 2) of the rotation theta of a body since the start of the step."""
    total = 0.0
    for k in range(9):
        total += (b.A[k] - b.start_A[k]) ** 2
    return sqrt(0.5 * total)


@kernel
def leaves_list(elements, nodes, references, slack):
    """Whether an element has moved farther than the list of near pairs allows [m]."""
    for i in range(elements.shape[0]):
        e = elements[i]
        at = world_position(nodes[e.node], vec(e.point))
        if norm(sub(at, vec(references[i].r))) > slack:
            return True
    return False
