"""Hu-Guo contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e) / (2 e)

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.488, for 0.8 it returns 0.799.

References: Hu and Guo (2015), Multibody Syst. Dyn. 35, 131-151.
"""

from math import inf

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class HuGuo(shared.DampedPowerCard):
    """Hu-Guo force (good for restitution above 0.4)."""

    def chi(self) -> float:
        e = self.restitution
        return 1.5 * (1.0 - e) / e if e > 0.0 else inf
