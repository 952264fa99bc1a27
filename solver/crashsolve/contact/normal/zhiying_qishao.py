"""Contact force of Zhiying Qin and Qishao Lu, known by their given names.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e^2) exp(2 (1 - e)) / 4

v_0 is the closing speed at the onset. Consequence to test: with e = 0.9 a free impact returns
0.896, for 0.5 it returns 0.483, and for e = 0 still 0.179.

References: Qin and Lu (2006), J. Dynamics and Control 4(4), 294-298.
"""

from math import exp

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class ZhiyingQishao(shared.DampedPowerCard):
    """Zhiying-Qishao force: within 0.03 of the given restitution, where that is above 0.3."""

    def chi(self) -> float:
        e = self.restitution
        return 0.75 * (1.0 - e * e) * exp(2.0 * (1.0 - e))
