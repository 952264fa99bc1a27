"""Coulomb friction that fades out at low sliding speed.

    f = -mu f_d N v/|v|,   f_d = 0 | (|v| - v_0)/(v_1 - v_0) | 1   below v_0 | between | above v_1

v is the tangential velocity of a relative to b (the chapter prints the whole velocity of the node).
v_0 and v_1 are corners: methods that choose their steps by error end them there. In explicit steps
v is the slip that friction leaves (`_regularised.py`).
Nothing rests on a slope. Consequence to test: on a slope below the friction angle a block creeps
at v_0 + (v_1 - v_0) tan(slope)/mu.

References: Ambrosio (2003), Eq. 21-22.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import vec
from crashsolve.friction import _regularised as regularised
from crashsolve.friction._card import columns
from crashsolve.friction._regularised import (
    against,
    half_steps_ahead,
    least_rise,
    speed,
    without_friction,
)

if TYPE_CHECKING:
    from crashsolve.friction._rows.coulomb import History, Parameters

LEFT_OUT = "the speeds over which friction sets in"


class Coulomb(Card):
    """Coulomb friction that vanishes at low sliding speed: a body on a slope creeps."""

    friction_coefficient: float = quantity("1", "mu, coefficient of friction", ge=0)
    none_below: float = quantity("m/s", "sliding speed v_0 below which there is no friction", ge=0)
    full_above: float = quantity("m/s", "sliding speed v_1 above which friction is full", gt=0)

    @model_validator(mode="after")
    def _in_order(self) -> Coulomb:
        if self.full_above <= self.none_below:
            raise ValueError(f"full_above: must exceed none_below, {self.none_below:g} m/s")
        return self


PARAMETERS = Record("""
    friction_coefficient  1    mu
    friction_none_below   m/s  v_0
    friction_full_above   m/s  v_1
""")
HISTORY = Record("friction_regime  index  0 below v_0, 1 between, 2 from v_1 on")
build = columns


@kernel
def friction_force(p: Parameters, old: History, new: History, slide, curves):
    """Force on a [N], stored [J], power [W], loss [J], stiffness, damping. Writes: new."""
    friction_force = vec(old.friction_force)
    full = p.friction_coefficient * slide.normal_force
    rise = max(p.friction_full_above - p.friction_none_below, least_rise(slide, full))
    ahead = half_steps_ahead(slide, full / rise)
    free = without_friction(slide, ahead, friction_force)
    v = speed(free)
    new.friction_regime = (1 if v >= p.friction_none_below else 0) + (
        1 if v >= p.friction_full_above else 0
    )
    taken = ahead * slide.compliance * full
    share = min(max((v - p.friction_none_below) / (rise + taken), 0.0), 1.0)
    return against(free, v, full * share, full / rise, friction_force, slide.displacement)


@kernel
def slip_rate(p: Parameters, slide, h):
    """Relative change of the slip per time, where there is friction [1/s]."""
    if p.friction_coefficient == 0.0:
        return 0.0
    return regularised.slip_rate(slide, h, p.friction_none_below, p.friction_full_above)


@kernel
def regime_left(p: Parameters, old: History, slip):
    """Difference of the sliding speed from the regime of the start of the step [m/s]."""
    v = speed(slip)
    if old.friction_regime == 0:
        return v - p.friction_none_below
    if old.friction_regime == 2:
        return p.friction_full_above - v
    return max(p.friction_none_below - v, v - p.friction_full_above)


@kernel
def release(p: Parameters, old: History, new: History):
    """Nothing is remembered after separation. Writes: new."""
    new.friction_regime = 0


@kernel
def friction_tangent(p: Parameters, normal_force, slip):
    """Rise of the friction over the sliding speed, along and across the slip [N s/m]."""
    v = speed(slip)
    if v <= p.friction_none_below:
        return 0.0, 0.0
    full = p.friction_coefficient * normal_force
    rise = p.friction_full_above - p.friction_none_below
    if v >= p.friction_full_above:
        return 0.0, full / v
    return full / rise, full * (v - p.friction_none_below) / (rise * v)
