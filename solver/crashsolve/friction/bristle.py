"""Stick and slip by an elastic bristle: a contact that sticks does not creep.

    z = z_old + slip over the step, kept tangential and cut to |z| <= mu N / k
    f = -(k z + c v), cut to mu N,   mu = mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)

While nothing is cut the contact is a spring and a damper, so that a load below mu_s N is held for
ever without creep (unlike LuGre's bristle, which drifts under vibration). The cut takes
k/2 (z_old + z).(z_trial - z), by which work and loss agree exactly for any step. Consequences
to test: steady sliding loses mu N per length; a block on a slope below the friction angle rests.

References: Cundall and Strack (1979), Geotechnique 29, 47-65; Dupont, Hayward, Armstrong and
Altpeter (2002), IEEE Trans. Autom. Control 47, 787-792.
"""

from __future__ import annotations

from math import exp, sqrt
from typing import TYPE_CHECKING

from pydantic import model_validator

from crashsolve.deck.card import Card, quantity
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.friction._card import columns

if TYPE_CHECKING:
    from crashsolve.friction._rows.bristle import History, Parameters


class Bristle(Card):
    """Stick and slip by an elastic bristle: a body on a slope rests without creep."""

    stiffness: float = quantity("N/m", "k of the bristle", gt=0)
    damping_ratio: float = quantity(
        "1", "c over critical, with the effective mass of both sides", 0.5, ge=0
    )
    static: float = quantity("1", "mu_s", ge=0)
    dynamic: float = quantity("1", "mu_d, dynamic coefficient", ge=0)
    stribeck_speed: float = quantity(
        "m/s", "v_s, sliding speed over which static falls to dynamic", 1e-2, gt=0
    )

    @model_validator(mode="after")
    def _in_order(self) -> Bristle:
        if self.static < self.dynamic:
            raise ValueError(f"static: must not be below dynamic, {self.dynamic:g}")
        return self


# the bristle is stretched by the slip of a whole step
STEPWISE = True
PARAMETERS = Record("""
    friction_stiffness       N/m  k
    friction_damping_ratio   1    c / (2 sqrt(k m))
    friction_static          1    mu_s
    friction_dynamic         1    mu_d
    friction_stribeck_speed  m/s  v_s
""")
HISTORY = Record("bristle  m  3  elastic slip z of a over b")
build = columns


@kernel
def friction_force(p: Parameters, old: History, new: History, slide, curves):
    """Force on a [N], stored [J], power [W], loss [J], stiffness, damping. Writes: new."""
    k, slip, displacement = p.friction_stiffness, slide.slip, slide.displacement
    c = 2.0 * p.friction_damping_ratio * sqrt(k * slide.mass)
    fall = exp(-dot(slip, slip) / p.friction_stribeck_speed**2)
    mu = p.friction_dynamic + (p.friction_static - p.friction_dynamic) * fall
    limit = slide.normal_force * mu
    # at the onset there is no step behind: the bristle starts straight
    start, trial = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if old.active == 1:
        start = rotated(vec(old.bristle), slide.n)
        trial = add(start, displacement)
    z = cut(trial, limit / k)
    put(new.bristle, z)
    spring = scale(k, z)
    pull = cut(add_scaled(spring, c, slip), limit)
    # of the damper, at the start of the step and at its end
    damped = sub(sub(pull, spring), add_scaled(vec(old.friction_force), k, vec(old.bristle)))
    loss = 0.5 * (k * dot(add(start, z), sub(trial, z)) + dot(damped, displacement))
    return scale(-1.0, pull), 0.5 * k * dot(z, z), 0.0, loss, k, c


@kernel
def rotated(x, n):
    """Vector x (3) laid into the plane normal to n, its length kept."""
    flat = add_scaled(x, -dot(x, n), n)
    length = norm(flat)
    return scale(norm(x) / length, flat) if length > 0.0 else flat


@kernel
def cut(x, limit):
    """Vector x (3) shortened to the length `limit` if it is longer."""
    length = norm(x)
    return scale(limit / length, x) if length > limit else x


@kernel
def release(p: Parameters, old: History, new: History):
    """The bristle is straight again; its energy was lost with the normal force. Writes: new."""
    put(new.bristle, (0.0, 0.0, 0.0))
