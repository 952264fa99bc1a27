"""Lankarani-Nikravesh contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e^2) / 4

v_0 is the closing speed at the onset. Consequence to test: a free impact never returns less than
0.663, that for e = 0; for e = 0.9 it returns 0.913.

References: Ambrosio (2003), Eq. 17-20; Lankarani and Nikravesh (1990), J. Mech. Design 112,
369-376.
"""

from typing import Any

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS = shared.PARAMETERS, shared.HISTORY, shared.WARNINGS
normal_force, normal_tangent = shared.normal_force, shared.normal_tangent
release = shared.release


class LankaraniNikravesh(shared.DampedPowerCard):
    """Lankarani-Nikravesh force as printed in the chapter (usable for restitution above 0.9)."""


def build(card: LankaraniNikravesh, scene: Any, pair: Any) -> dict[str, Any]:
    return shared.damped_law(card, scene, pair, chi=0.75 * (1.0 - card.restitution**2))
