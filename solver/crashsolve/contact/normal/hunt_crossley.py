"""Hunt-Crossley contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e) / 2

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.663, for e = 0 it returns 0.488; near 1 it is exact to first order.

References: Hunt and Crossley (1975), J. Appl. Mech. 42, 440-445.
"""

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class HuntCrossley(shared.DampedPowerCard):
    """Hunt-Crossley force (usable for restitution above 0.9)."""

    def chi(self) -> float:
        return 1.5 * (1.0 - self.restitution)
