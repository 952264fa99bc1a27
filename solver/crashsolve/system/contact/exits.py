"""The shortest exit of an overlap, followed from step to step while no other can be shorter.

The depth of two bodies that overlap is that along their shortest exit, one of several. Seen from
body b, no point of a moves by more than `displacement` in a step (system/contact/resting.py), and
so does the depth along any direction carried along with b change by no more. An exit
that is shorter than the next one by `remaining_lead` therefore remains so until both have changed
by half of that. An exit that emerges in between has not been searched for: hence no lead counts for
more than LARGEST_LEAD of the half thickness of both sides. Consequence to test: the results of a
search in every step.
"""

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.vec3 import add, add_scaled, cross, dot, scale, vec

# largest lead that is trusted, in shares of the half thickness of both sides
LARGEST_LEAD = 0.01


@kernel
def remaining_lead(h, old, displacement):
    """Lead of the exit of the last step after this one [m]; none where it did not touch."""
    if old.active == 0:
        return 0.0
    return old.remaining_lead if h == 0.0 else old.remaining_lead - 2.0 * displacement


@kernel
def trusted_lead(p, lead):
    """Trusted part of the lead of an exit that has been searched for [m]."""
    return min(lead, LARGEST_LEAD * p.thick)


@kernel
def carried_normal(h, old, body):
    """Normal of the last step, rotated with the body that it points out of."""
    n, tau = vec(old.normal), vec(body.rotated)
    if h == 0.0:
        return n
    across = cross(tau, n)
    change = add_scaled(across, 0.5, cross(tau, across))
    return add(n, scale(1.0 / (1.0 + 0.25 * dot(tau, tau)), change))
