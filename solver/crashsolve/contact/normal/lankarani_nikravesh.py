"""Lankarani-Nikravesh contact force, as printed in the chapter.

    f = K delta^n [ 1 + 3 (1 - e^2) / 4 * delta_dot / v_0 ]        (Ambrosio (2003), Eq. 17-20)

v_0 is the closing speed at the onset. Consequence to test: a free impact returns the speed ratio x
with chi (1 + x) = ln[(1 + chi) / (1 - chi x)], chi = 3 (1 - e^2) / 4: never less than 0.663.

References: Lankarani and Nikravesh (1990), J. Mech. Design 112, 369-376.
"""

from typing import Any

from crashsolve.contact.normal._hunt_crossley_form import (
    OUTPUT_COLUMNS,
    DampedPowerCard,
    damped_power,
    power_parameters,
)
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.record import Record


class LankaraniNikravesh(DampedPowerCard):
    """Lankarani-Nikravesh force as printed in the chapter (usable for restitution above 0.9)."""


PARAMETERS = Record(**OUTPUT_COLUMNS)
HISTORY = Record()


def build(card: LankaraniNikravesh, scene: Any, pair: Any) -> dict[str, Any]:
    return power_parameters(card, pair, chi=0.75 * (1.0 - card.restitution**2))


@kernel
def normal_force(p, old, new, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping."""
    return damped_power(p, new, depth, rate, mass)


@kernel
def release(p, old, new):
    """Nothing is remembered after separation."""
