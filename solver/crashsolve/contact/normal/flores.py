"""Flores contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 8 (1 - e) / (5 e)

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.470, for 0.1 it returns 0.069.

References: Flores, Machado, Silva and Martins (2011), Multibody Syst. Dyn. 25, 357-375.
"""

from math import inf

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class Flores(shared.DampedPowerCard):
    """Flores force for soft materials (good for restitution above 0.5)."""

    def chi(self) -> float:
        e = self.restitution
        return 1.6 * (1.0 - e) / e if e > 0.0 else inf
