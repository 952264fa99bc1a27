"""Herbert-McWhannell contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 6 (1 - e) / ((2 e - 1)^2 + 3)

v_0 is the closing speed at the onset. Consequence to test: with e = 0.5 a free impact returns
0.594, for e = 0 it returns 0.488.

References: Herbert and McWhannell (1977), J. Eng. Ind. 99, 513-518.
"""

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class HerbertMcwhannell(shared.DampedPowerCard):
    """Herbert-McWhannell force (usable for restitution above 0.8)."""

    def chi(self) -> float:
        e = self.restitution
        return 6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0)
