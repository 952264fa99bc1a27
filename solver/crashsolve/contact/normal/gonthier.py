"""Gonthier contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = (1 - e^2) / e

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.488, for 0.1 it returns 0.101: off by less than 5 % everywhere.

References: Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233.
"""

from math import inf

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class Gonthier(shared.DampedPowerCard):
    """Gonthier force: close to the given restitution over the whole range."""

    def chi(self) -> float:
        e = self.restitution
        return (1.0 - e * e) / e if e > 0.0 else inf
