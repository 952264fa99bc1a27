"""Lankarani-Nikravesh contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e^2) / 4

v_0 is the closing speed at the onset. Consequence to test: a free impact never returns less than
0.663, that for e = 0; for e = 0.9 it returns 0.913.

References: Ambrosio (2003), Eq. 17-20; Lankarani and Nikravesh (1990), J. Mech. Design 112,
369-376.
"""

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS, REMARKS, build, *KERNELS = shared.LAW
normal_force, normal_tangent, release, rate_slope, implicit_rate, resolved_slopes = KERNELS


class LankaraniNikravesh(shared.DampedPowerCard):
    """Lankarani-Nikravesh force as printed in the chapter (usable for restitution above 0.9)."""

    def chi(self) -> float:
        return 0.75 * (1.0 - self.restitution**2)
