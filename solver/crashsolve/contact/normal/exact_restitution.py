"""Damped power-law contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi (1 + e) = ln[(1 + chi) / (1 - chi e)]

v_0 is the closing speed at the onset. Consequence to test: a free central impact returns the
requested restitution, for any K, n, mass and speed.

References: Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233, the
implicit form before its approximation.
"""

from math import inf

from crashsolve.contact.normal import _damped_power as shared
from crashsolve.contact.normal._restitution import damping_factor

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class ExactRestitution(shared.DampedPowerCard):
    """Damped power law that returns exactly the requested restitution."""

    def chi(self) -> float:
        e = self.restitution
        return damping_factor(e) if e > 0.0 else inf
