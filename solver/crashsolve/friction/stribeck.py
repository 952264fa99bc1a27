"""Smooth friction with a static peak, a dynamic level and a viscous part.

    f = -N [ (mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)) tanh(v/v_t) + k_v v ] v/|v|

Nothing rests on a slope: a block creeps where the bracket equals the tangent of the slope.
Consequence to test: far above v_s the force is N (mu_d + k_v v); the bracket starts with slope
mu_s / v_t + k_v.

References: Stribeck (1902), Z. VDI 46; Andersson, Soederberg and Bjoerklund (2007), Tribology
International 40, 580-587.
"""

from __future__ import annotations

from math import exp, tanh
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
    from crashsolve.friction._rows.stribeck import History, Parameters

# of the slip without friction, that which is left; a dozen iterations find it
CLOSED, ITERATIONS = 1e-13, 60

LEFT_OUT = "the speeds over which friction sets in"


class Stribeck(Card):
    """Smooth friction with static peak, dynamic level and viscous part: bodies creep on a slope."""

    static: float = quantity("1", "mu_s", ge=0)
    dynamic: float = quantity("1", "mu_d, dynamic coefficient", ge=0)
    stribeck_speed: float = quantity("m/s", "v_s, speed over which mu_s falls to mu_d", gt=0)
    viscous: float = quantity("s/m", "k_v, growth of the coefficient with speed", 0.0, ge=0)
    smoothing_speed: float = quantity("m/s", "v_t, speed over which friction grows from zero", gt=0)

    @model_validator(mode="after")
    def _in_order(self) -> Stribeck:
        if self.static < self.dynamic:
            raise ValueError(f"static: must not be below dynamic, {self.dynamic:g}")
        return self


PARAMETERS = Record("""
    friction_static           1    mu_s
    friction_dynamic          1    mu_d
    friction_stribeck_speed   m/s  v_s
    friction_viscous          s/m  k_v
    friction_smoothing_speed  m/s  v_t
""")
HISTORY = Record()
build = columns


@kernel
def friction_force(p: Parameters, old: History, new: History, slide, curves):
    """Force on a [N], stored [J], power [W], loss [J], stiffness and damping [N s/m]."""
    friction_force = vec(old.friction_force)
    normal_force, steep = slide.normal_force, steepest(p) * slide.normal_force
    widened = max(1.0, least_rise(slide, steep))
    ahead = half_steps_ahead(slide, steep)
    if ahead > 1.0:
        # sliding fast it needs less: the chord to rest is as steep as the law at the slip left
        v, taken = speed(without_friction(slide, ahead, friction_force)), 2.0 * slide.compliance
        v = slip_left(p, v, widened, taken * normal_force)
        ahead = half_steps_ahead(slide, chord(p, v, widened) * normal_force)
    free = without_friction(slide, ahead, friction_force)
    v, taken = speed(free), ahead * slide.compliance * normal_force
    mu = coefficient(p, slip_left(p, v, widened, taken), widened, taken)
    return against(free, v, mu * normal_force, steep, friction_force, slide.displacement)


@kernel
def chord(p: Parameters, v, widened):
    """Coefficient at the sliding speed v over that speed [s/m]."""
    return coefficient(p, v, widened, 0.0) / v if v > 0.0 else steepest(p)


@kernel
def steepest(p: Parameters):
    """Largest rise of the friction coefficient over the sliding speed [s/m]."""
    return p.friction_static / p.friction_smoothing_speed + p.friction_viscous


@kernel
def coefficient(p: Parameters, v, widened, taken):
    """Friction over normal force at sliding speed v [m/s]; it falls by 1 / taken at most."""
    drop = p.friction_static - p.friction_dynamic
    peak = drop * exp(-((v / max(p.friction_stribeck_speed, taken * drop)) ** 2))
    smooth = tanh(v / (widened * p.friction_smoothing_speed))
    return (p.friction_dynamic + peak) * smooth + p.friction_viscous / widened * v


@kernel
def slip_left(p: Parameters, v_free, widened, taken):
    """Root v [m/s] of v + taken mu(v) = v_free, by the Illinois rule; both sides of it rise."""
    if taken * v_free == 0.0:
        return v_free
    low, high = 0.0, v_free
    residual_low, residual_high = -v_free, taken * coefficient(p, v_free, widened, taken)
    v, was_high = v_free, False
    for k in range(ITERATIONS):
        v = high - residual_high * (high - low) / (residual_high - residual_low)
        residual = v + taken * coefficient(p, v, widened, taken) - v_free
        if abs(residual) <= CLOSED * v_free:
            break
        is_high = residual > 0.0
        if is_high:
            high, residual_high = v, residual
            residual_low *= 0.5 if k > 0 and was_high else 1.0
        else:
            low, residual_low = v, residual
            residual_high *= 0.5 if k > 0 and not was_high else 1.0
        was_high = is_high
    return v


@kernel
def slip_rate(p: Parameters, slide, h):
    """Relative change of the slip per time, where there is friction [1/s]."""
    if steepest(p) == 0.0:
        return 0.0
    return regularised.slip_rate(slide, h, 0.0, p.friction_smoothing_speed)


@kernel
def release(p: Parameters, old: History, new: History):
    """Nothing is remembered after separation."""


@kernel
def friction_tangent(p: Parameters, normal_force, slip):
    """Rise of the friction over the sliding speed, along and across the slip [N s/m]."""
    v, v_s = speed(slip), p.friction_stribeck_speed
    peak = (p.friction_static - p.friction_dynamic) * exp(-((v / v_s) ** 2))
    smooth = tanh(v / p.friction_smoothing_speed)
    mu = p.friction_dynamic + peak
    along = mu * (1.0 - smooth * smooth) / p.friction_smoothing_speed + p.friction_viscous
    along -= 2.0 * v / (v_s * v_s) * peak * smooth
    across = mu * smooth / v + p.friction_viscous if v > 0.0 else along
    return normal_force * along, normal_force * across
