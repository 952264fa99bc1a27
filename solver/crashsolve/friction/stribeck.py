"""Smooth friction with a static peak, a dynamic level and a viscous part.

    f = -N [ (mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)) tanh(v/v_t) + k_v v ] v/|v|

Nothing rests on a slope: a block creeps where the bracket equals the tangent of the slope.
Consequence to test: far above v_s the force is N (mu_d + k_v v); the bracket starts with slope
mu_s / v_t + k_v.

References: Stribeck (1902), Z. VDI 46; Andersson, Soederberg and Bjoerklund (2007), Tribology
International 40, 580-587.
"""

from math import exp, tanh
from typing import Any

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.record import Record
from crashsolve.friction._regularised import against, speed


class Stribeck(Card):
    """Smooth friction: static peak, dynamic level, viscous part; nothing rests on a slope."""

    static: float = quantity("1", "mu_s", ge=0)
    dynamic: float = quantity("1", "mu_d", ge=0)
    stribeck_speed: float = quantity("m/s", "v_s, over which static falls to dynamic", gt=0)
    viscous: float = quantity("s/m", "k_v, growth of the coefficient with speed", 0.0, ge=0)
    smoothing_speed: float = quantity("m/s", "v_t, over which friction sets in", gt=0)

    @model_validator(mode="after")
    def _in_order(self) -> "Stribeck":
        if self.static < self.dynamic:
            raise ValueError(f"static: must not be below dynamic, {self.dynamic:g}")
        return self


PARAMETERS = Record(
    friction_static=("1", "mu_s"),
    friction_dynamic=("1", "mu_d"),
    friction_stribeck=("m/s", "v_s"),
    friction_viscous=("s/m", "k_v"),
    friction_smoothing=("m/s", "v_t"),
)
HISTORY = Record()


def build(card: Stribeck, scene: Any) -> dict[str, Any]:
    return {
        "friction_static": card.static,
        "friction_dynamic": card.dynamic,
        "friction_stribeck": card.stribeck_speed,
        "friction_viscous": card.viscous,
        "friction_smoothing": card.smoothing_speed,
    }


@kernel
def friction_force(p, old, new, h, normal_force, slip, n, mass, curves):
    """Returns force on a, stored energy, dissipated power, loss, stiffness, damping."""
    v = speed(slip)
    peak = (p.friction_static - p.friction_dynamic) * exp(-((v / p.friction_stribeck) ** 2))
    mu = (p.friction_dynamic + peak) * tanh(v / p.friction_smoothing) + p.friction_viscous * v
    steepest = p.friction_static / p.friction_smoothing + p.friction_viscous
    return against(slip, v, mu * normal_force, steepest * normal_force)


@kernel
def release(p, old, new):
    """Nothing is remembered after separation."""


@kernel
def friction_tangent(p, normal_force, slip):
    """Rise of the friction over the sliding speed, along and across the slip [N s/m]."""
    v, v_s = speed(slip), p.friction_stribeck
    peak = (p.friction_static - p.friction_dynamic) * exp(-((v / v_s) ** 2))
    smooth = tanh(v / p.friction_smoothing)
    mu = p.friction_dynamic + peak
    along = mu * (1.0 - smooth * smooth) / p.friction_smoothing + p.friction_viscous
    along -= 2.0 * v / (v_s * v_s) * peak * smooth
    across = mu * smooth / v + p.friction_viscous if v > 0.0 else along
    return normal_force * along, normal_force * across
