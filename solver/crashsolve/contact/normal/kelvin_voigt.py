"""Linear spring and damper in parallel, never tensile.

    f = max(0, k delta + c delta_dot),   c = 2 zeta sqrt(k m)

With `restitution` e the damping ratio zeta solves

    e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)),   acosh and zeta^2 - 1 where zeta > 1

which is the damped half period cut where the force would turn tensile, and m is the effective mass
of the whole touch along the normal: of all positions in which the bodies strike at once, and of
the bodies that joints connect with them (system/contact/effective_mass.py). Consequence to test: a
free central impact returns exactly e, and so do a box on its corners and a ball welded to another.

References: Schwager and Poeschel (2007), Granular Matter 9, 465-469.
"""

from __future__ import annotations

from math import acos, acosh, exp, sqrt
from typing import TYPE_CHECKING

from pydantic import model_validator

from crashsolve.deck.building import Columns, Pair, Scene
from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.contact.normal._rows.kelvin_voigt import History, Parameters


class KelvinVoigt(Card):
    """Linear spring and damper; the damping given, or from the restitution."""

    stiffness: float = quantity("N/m", "k, stiffness", gt=0)
    damping: float | None = quantity("N s/m", "c; or give restitution", None, ge=0)
    restitution: float | None = quantity(
        "1", "e of a free impact; or give damping", None, gt=0, le=1
    )

    @model_validator(mode="after")
    def _one_damping(self) -> KelvinVoigt:
        if (self.damping is None) == (self.restitution is None):
            raise ValueError("give one of: damping, restitution")
        return self


PARAMETERS = Record("""
    stiffness      N/m    k
    damping        N s/m  c
    damping_ratio  1      zeta, adds 2 zeta sqrt(k m) to c
""")
HISTORY = Record("""
    mass_ratio  1  effective mass of the touch over that of its two bodies alone; 0: not known yet
""")


def build(card: KelvinVoigt, scene: Scene, pair: Pair) -> Columns:
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
def normal_force(p: Parameters, old: History, new: History, h, depth, rate, mass, curves):
    """Returns force, stored energy, dissipated power, loss, stiffness, damping. Writes: new."""
    new.mass_ratio = old.mass_ratio if old.active == 1 else 0.0
    c = damping_of(p, new, mass)
    spring = p.stiffness * depth
    f = max(0.0, spring + c * rate)
    return f, 0.5 * spring * depth, (f - spring) * rate, 0.0, p.stiffness, c


@kernel
def release(p: Parameters, old: History, new: History):
    """Writes: new."""
    new.mass_ratio = 0.0


@kernel
def damping_of(p: Parameters, state: History, mass):
    """Damping c with the effective mass of the touch, of the two bodies until it is known."""
    if state.mass_ratio > 0.0:
        mass *= state.mass_ratio
    return p.damping + 2.0 * p.damping_ratio * sqrt(p.stiffness * mass)


@kernel
def normal_tangent(p: Parameters, state: History, depth, rate, mass, curves):
    """Rise of the force over the depth and over its rate."""
    c = damping_of(p, state, mass)
    if p.stiffness * depth + c * rate <= 0.0:
        return 0.0, 0.0
    return p.stiffness, c
