"""Herbert-McWhannell contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 6 (1 - e) / ((2 e - 1)^2 + 3)

v_0 is the closing speed at the onset. Consequence to test: asked for e = 0.5 a free impact returns
0.594, for e = 0 it returns 0.488.

References: Herbert and McWhannell (1977), J. Eng. Ind. 99, 513-518.
"""

from typing import Any

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS = shared.PARAMETERS, shared.HISTORY, shared.WARNINGS
normal_force, normal_tangent = shared.normal_force, shared.normal_tangent
release = shared.release


class HerbertMcwhannell(shared.DampedPowerCard):
    """Herbert-McWhannell force (usable for restitution above 0.8)."""


def build(card: HerbertMcwhannell, scene: Any, pair: Any) -> dict[str, Any]:
    e = card.restitution
    return shared.damped_law(card, scene, pair, chi=6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0))
