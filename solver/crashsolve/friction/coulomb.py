"""Coulomb friction that fades out at low sliding speed.

    f = -mu f_d N v/|v|,   f_d = 0 | (|v| - v_0)/(v_1 - v_0) | 1   below v_0 | between | above v_1

v is the tangential velocity of a relative to b (the chapter prints the whole velocity of the node).
Nothing rests on a slope. Consequence to test: on a slope below the friction angle a block creeps
at v_0 + (v_1 - v_0) tan(slope)/mu.

References: Ambrosio (2003), Eq. 21-22.
"""

from typing import Any

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.record import Record
from crashsolve.friction._regularised import against, speed


class Coulomb(Card):
    """Coulomb friction that fades out at low sliding speed; nothing rests on a slope."""

    coefficient: float = quantity("1", "mu", ge=0)
    none_below: float = quantity("m/s", "sliding speed v_0 below which there is no friction", ge=0)
    full_above: float = quantity("m/s", "sliding speed v_1 above which friction is full", gt=0)

    @model_validator(mode="after")
    def _in_order(self) -> "Coulomb":
        if self.full_above <= self.none_below:
            raise ValueError(f"full_above: must exceed none_below, {self.none_below:g} m/s")
        return self


PARAMETERS = Record(
    friction_coefficient=("1", "mu"),
    friction_none_below=("m/s", "v_0"),
    friction_full_above=("m/s", "v_1"),
)
HISTORY = Record()


def build(card: Coulomb, scene: Any) -> dict[str, Any]:
    return {
        "friction_coefficient": card.coefficient,
        "friction_none_below": card.none_below,
        "friction_full_above": card.full_above,
    }


@kernel
def friction_force(p, old, new, h, normal_force, slip, n, mass, curves):
    """Returns force on a, stored energy, dissipated power, loss, stiffness, damping."""
    v = speed(slip)
    rise = p.friction_full_above - p.friction_none_below
    share = min(max((v - p.friction_none_below) / rise, 0.0), 1.0)
    full = p.friction_coefficient * normal_force
    return against(slip, v, full * share, full / rise)


@kernel
def release(p, old, new):
    """Nothing is remembered after separation."""


@kernel
def friction_tangent(p, normal_force, slip):
    """Rise of the friction over the sliding speed, along and across the slip [N s/m]."""
    v = speed(slip)
    if v <= p.friction_none_below:
        return 0.0, 0.0
    full = p.friction_coefficient * normal_force
    rise = p.friction_full_above - p.friction_none_below
    if v >= p.friction_full_above:
        return 0.0, full / v
    return full / rise, full * (v - p.friction_none_below) / (rise * v)
