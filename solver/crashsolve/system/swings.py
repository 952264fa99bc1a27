"""Bodies that springs or dampers move faster than a stated step can follow, see timestep.py."""

from collections.abc import Sequence
from math import hypot

import numpy as np

# frequency times step, from which a vibration is reported as too fast for it: by kick, drift, kick
# it is 1 / sqrt(1 - (omega h / 2)^2) too wide, three times here, and grows from 2 on
FASTEST_SWING = 1.9


def swing_warnings(clock: np.void, bodies: Sequence[str]) -> list[str]:
    """Warning that springs or dampers move a body faster than a stated step can follow.

    The work of a spring does not show it: that of a linear one equals its stored energy in any
    step. A bounded force that turns a velocity round in every step does none.
    """
    node, swing = int(clock["swing_node"]), float(clock["swing"])
    if swing < FASTEST_SWING or node >= len(bodies):
        return []
    omega, damping = float(clock["swing_square"]) ** 0.5, float(clock["swing_damping"])
    limit = 2.0 / (hypot(omega, 0.5 * damping) + 0.5 * damping)
    step, name = 0.5 * swing * limit, bodies[node]
    if damping > 2.0 * omega:
        message = (
            f"body '{name}': dampers, friction or contacts stop it within {1.0 / damping:.2g} "
            f"s, unless joints hold it; steps of {step:.4g} s reverse its velocity instead"
        )
    else:
        message = (
            f"body '{name}': springs and contacts let it vibrate at {omega:.4g} rad/s, unless "
            f"joints hold it; steps of {step:.4g} s amplify this, and from {limit:.4g} s on it "
            "grows without bound"
        )
    return [f"{message}: take control.step below {0.5 * limit:.2g} s"]
