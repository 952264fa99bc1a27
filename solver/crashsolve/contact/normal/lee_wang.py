"""Lee-Wang contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e) / 4

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.799, for e = 0 it returns 0.663; the least damped law of the family.

References: Lee and Wang (1983), J. Mech. Trans. Autom. Design 105, 534-540.
"""

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class LeeWang(shared.DampedPowerCard):
    """Lee-Wang force (usable for restitution above 0.9)."""

    def chi(self) -> float:
        return 0.75 * (1.0 - self.restitution)
