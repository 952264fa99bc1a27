"""Linear spring and damper in parallel, never tensile.

    f = max(0, k delta + c delta_dot),   c = 2 zeta sqrt(k m)

With `restitution` e the damping ratio zeta solves

    e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)),   acosh and zeta^2 - 1 where zeta > 1

which is the damped half period cut where the force would turn tensile, and m is the effective mass
of the two bodies along the normal. Consequence to test: a free central impact returns exactly e.

References: Schwager and Poeschel (2007), Granular Matter 9, 465-469.
"""

from math import acos, acosh, exp, sqrt
from typing import Any

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record


class KelvinVoigt(Card):
    """Linear spring and damper; the damping given, or from the restitution."""

    stiffness: float = quantity("N/m", "k", gt=0)
    damping: float | None = quantity("N s/m", "c; or give restitution", None, ge=0)
    restitution: float | None = quantity(
        "1", "e of a free impact; or give damping", None, gt=0, le=1
    )

    @model_validator(mode="after")
    def _one_damping(self) -> "KelvinVoigt":
        if (self.damping is None) == (self.restitution is None):
            raise ValueError("give one of: damping, restitution")
        return self


# shapes that touch in more than one position
MANY_PLACES = {"box", "cylinder", "mesh"}
PARAMETERS = Record("""
    stiffness      N/m    k
    damping        N s/m  c
    damping_ratio  1      zeta, adds 2 zeta sqrt(k m) to c
""")
HISTORY = Record()


def build(card: KelvinVoigt, scene: Any, pair: Any) -> dict[str, Any]:
    ratio = damping_ratio(card.restitution) if card.restitution is not None else 0.0
    return {
        "stiffness": card.stiffness,
        "damping": card.damping or 0.0,
        "damping_ratio": ratio,
    }


def returned(ratio: float) -> float:
    """Restitution [1] of a free impact with damping ratio zeta [1]."""
    if ratio == 1.0:
        return exp(-2.0)
    angle = acos(ratio) if ratio < 1.0 else acosh(ratio)
    return exp(-2.0 * ratio * angle / sqrt(abs(1.0 - ratio * ratio)))


def damping_ratio(e: float) -> float:
    """Damping ratio zeta [1] that returns the restitution e, by bisection to the last bit."""
    # e > 1 / (2 zeta)^4 bounds the root from above
    low, high = 0.0, 0.5 * e**-0.5 + 1.0
    while low < (middle := 0.5 * (low + high)) < high:
        if returned(middle) > e:
            low = middle
        else:
            high = middle
    return low


@kernel
def normal_force(p, old, new, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping."""
    c = p.damping + 2.0 * p.damping_ratio * sqrt(p.stiffness * mass)
    spring = p.stiffness * depth
    f = max(0.0, spring + c * rate)
    return f, 0.5 * spring * depth, (f - spring) * rate, 0.0, p.stiffness, c


@kernel
def release(p, old, new):
    """Nothing is remembered after separation."""


@kernel
def normal_tangent(p, state, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate."""
    c = p.damping + 2.0 * p.damping_ratio * sqrt(p.stiffness * mass)
    if p.stiffness * depth + c * rate <= 0.0:
        return 0.0, 0.0
    return p.stiffness, c


def check(card: KelvinVoigt, scene: Any, bodies_a: set[int], bodies_b: set[int]) -> None:
    """Warn where the damping is not that of the whole touch."""
    if card.restitution is None or card.restitution == 1.0:
        return
    for name, entry in scene.deck.entries["contacts"].items():
        if getattr(entry.card, "normal", None) is not card:
            continue
        used = [scene.surfaces[n] for n in (*entry.card.a, *entry.card.b) if n in scene.surfaces]
        many = [s.entry.name for s in used if s.shape in MANY_PLACES or len(s.elements) > 1]
        nodes = {node for joint in scene.joints.values() for node in joint.nodes}
        held = sorted((bodies_a | bodies_b) & nodes - {0})
        cause = f"surface '{many[0]}' may touch in several positions at once" if many else ""
        cause = f"joints hold body '{scene.names[held[0]]}'" if held else cause
        if cause:
            scene.warn(
                f"contact '{name}': {cause}, and the damping of kelvin_voigt by restitution is "
                "that of one position on free bodies: it returns more than was asked; "
                "exact_restitution returns what is asked"
            )
