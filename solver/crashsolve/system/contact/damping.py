"""Damping of contacts by their closing speed at the end of the step, where stability needs it.

    f = f(depth, u),   u = u_predicted + eta / c (f_before - f),   eta = max(0, a - 1/2)
    a = h sum c_j w_j

u_predicted includes half a step of f_before, the force of the last step; the other term replaces
it by the present one. c = df/du is the damping of the contact, w_j the mobility of a body along
contact j; the sum is over all damped contacts on either body, as of the last step. Where a is at
most 1/2 the force is that of the predicted speed.

Let B be the diagonal of c, H that of eta / c, W the mobilities of all contacts, of bodies within
joints too. Steps of kick, drift and kick are stable for H >= h W / 2 - B^-1 / 2: with g, H and b
the quadratic forms of h W, H and B^-1 in a mode of the forces, its growth l in a step obeys

    (b + H) l^2 - (b + 2 H - 3 g / 2) l + H - g / 2 = 0

whose roots lie within the unit circle. With D_i = sum c_j w_j / c_i, D - W has no negative
eigenvalue: of each body |W_ij| <= sqrt(w_i w_j), so that c_i sqrt(w_i) is a vector by which the
diagonal dominates. H >= h D - B^-1 / 2 is therefore enough for dampers of any size, even where W
is as large as 2 D, as in a step in which contacts begin. Consequence to test: a body pressed
between dampers of any size comes to rest.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import dot, vec


@kernel
def clear_dampers(nodes):
    """Start the sums of dampers of this force pass. Writes: nodes."""
    for i in range(nodes.shape[0]):
        nodes[i].was_damped, nodes[i].damped = nodes[i].damped, 0.0


@kernel
def add_dampers(h, pair, totals, rate_a, rate_b):
    """Weight eta of the force of this pair; its rates are c times the mobilities of both bodies
    [1/s]. Writes: totals.
    """
    totals.on_a.damped += rate_a
    totals.on_b.damped += rate_b
    a = h * (max(pair.a.was_damped, rate_a) + max(pair.b.was_damped, rate_b))
    return max(0.0, a - 0.5)


@kernel
def force_before(old, n):
    """Normal force of the last step along the present normal [N]."""
    return dot(vec(old.normal_force), n) if old.active == 1 else 0.0
