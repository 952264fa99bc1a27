"""The force K delta^n (1 + chi delta_dot / v_0) that most restitution laws share.

They differ only in chi(e). The force is never tensile. The stiffness reported to the step control
is that at the depth a free impact of speed v_0 will reach, so the first step is already short.
"""

from typing import Any

from crashsolve.deck.card import Card, quantity, word
from crashsolve.foundation.compile import kernel


class DampedPowerCard(Card):
    """Stiffness (given, or from the materials by Hertz) and restitution."""

    stiffness: float = quantity("N/m^1.5", "K; its unit is N/m^exponent", gt=0)
    exponent: float = word("n, 1.5 for Hertz", default=1.5)
    restitution: float = word("e, 0 to 1", default=1.0)


OUTPUT_COLUMNS: dict[str, tuple[Any, ...]] = dict(
    stiffness=("N/m^n", "K"),
    exponent=("1", "n"),
    chi=("1", "damping factor of the law"),
)


def power_parameters(card: DampedPowerCard, pair: Any, chi: float) -> dict[str, Any]:
    return {"stiffness": card.stiffness, "exponent": card.exponent, "chi": chi}


@kernel
def damped_power(p, new, depth, rate, mass):
    """Force, stored energy, dissipated power, loss, stiffness, damping."""
    spring = p.stiffness * depth**p.exponent
    factor = max(0.0, 1.0 + p.chi * rate / new.impact_speed)
    f = spring * factor
    n = p.exponent
    stored = spring * depth / (n + 1.0)
    # energy that a free impact puts into the spring gives the depth to come
    deepest = ((n + 1.0) * 0.5 * mass * new.impact_speed**2 / p.stiffness) ** (1.0 / (n + 1.0))
    reach = max(depth, deepest)
    stiffness = n * p.stiffness * reach ** (n - 1.0) * (1.0 + p.chi)
    damping = p.chi * spring / new.impact_speed
    return f, stored, (f - spring) * rate, 0.0, stiffness, damping
