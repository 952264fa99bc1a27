"""Hu-Guo contact force.

    f = K delta^n (1 + chi delta_dot / v_0),   chi = 3 (1 - e) / (2 e)

v_0 is the closing speed at the onset. Consequence to test: asked for e = 0.5 a free impact returns
0.488, for 0.8 it returns 0.799.

References: Hu and Guo (2015), Multibody Syst. Dyn. 35, 131-151.
"""

from math import inf
from typing import Any

from crashsolve.contact.normal import _damped_power as shared

PARAMETERS, HISTORY, WARNINGS = shared.PARAMETERS, shared.HISTORY, shared.WARNINGS
normal_force, normal_tangent = shared.normal_force, shared.normal_tangent
release = shared.release


class HuGuo(shared.DampedPowerCard):
    """Hu-Guo force (good for restitution above 0.4)."""


def build(card: HuGuo, scene: Any, pair: Any) -> dict[str, Any]:
    e = card.restitution
    return shared.damped_law(card, scene, pair, chi=1.5 * (1.0 - e) / e if e > 0.0 else inf)
