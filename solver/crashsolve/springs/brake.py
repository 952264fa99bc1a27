"""Brake between two bodies: a friction force of a given level, which also holds at rest.

    f = K z + c z_dot while it holds,  z = s - s_p,   |f| <= F(t);   it slides (s_p follows) at F

s is the displacement of b against a along an axis of a, or in the plane at right angles to it. The
bristle z is elastic and the slider s_p moves only at the limit: a held body does not creep.

Consequence to test: a mass m sliding at v_0 stops after m v_0^2 / 2 F; below F it stays for ever.
The energy lost is the work of f less the energy of the bristle.

Reference: Dahl (1968), A solid friction model, The Aerospace Corporation TOR-0158; with the
elastic-perfectly plastic limit of Simo and Hughes (1998), Computational Inelasticity, 1.2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import CurveName, Vec3, quantity, word
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.orientation import perpendicular
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add_scaled, dot, norm, put, scale, sub, vec
from crashsolve.springs._between import (
    POINTS,
    add_stiffness_bound_along,
    push,
    relative_position,
    start_offset,
)
from crashsolve.springs._bristle import lost, retained_share
from crashsolve.springs._card import PointSpringCard

if TYPE_CHECKING:
    from crashsolve.springs._rows.brake import History, Output, Parameters

LEDGER = "brake"


class Brake(PointSpringCard):
    """Friction force of a given level between two bodies, which also holds at rest."""

    curve_axes: ClassVar = {"force_curve": ("s", "1")}

    axis: Vec3 = word("direction in the frame of a; any length")
    motion: Literal["along", "across"] = word(
        "braked motion: along the axis, or in the plane at right angles to it", default="along"
    )
    force: float = quantity("N", "level at which it slides; times force_curve", gt=0)
    force_curve: CurveName | None = word("factor on the level over time", default=None)
    stiffness: float = quantity("N/m", "K, stiffness of the bristle", gt=0)
    damping: float = quantity("N s/m", "c, of the bristle", default=0.0, ge=0)


# the bristle is stretched by the slip of a whole step
STEPWISE = True
CURVES_OF_TIME = ("force_curve",)
PARAMETERS = POINTS + Record("""
    first        1      3  first direction braked, axes of a
    second       1      3  second direction; 0 when only the first is braked
    offset       m      3  b from a at the start, axes of a
    force        N         F over the factor of the curve
    force_curve  index     factor over time; 0 for none
    stiffness    N/m       K
    damping      N s/m     c
""")
HISTORY = Record("""
    slider            m  3  s_p, axes of a
    bristle           m  3  z, axes of a
    force             N  3  f, axes of a
    accumulated_slip  m     distance slid
""")
OUTPUT = Record("""
    force             N  3  on b, axes of a
    limit             N     level at which it slides
    accumulated_slip  m     distance slid
""")


def build(card: Brake, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    axis = scene.unit(card.axis, "axis")
    side = perpendicular(axis)
    along = card.motion == "along"
    return ends | {
        "first": axis if along else side,
        "second": 0.0 * axis if along else np.cross(axis, side),
        "offset": start_offset(scene, ends),
        "force": card.force,
        "force_curve": scene.curve(card.force_curve) if card.force_curve else 0,
        "stiffness": card.stiffness,
        "damping": card.damping,
    }


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    x, x_dot, d_a, d_b = relative_position(p, nodes)
    trial = sub(braked(p, sub(x, vec(p.offset))), vec(old.slider))
    limit = level(p, t, curves)
    share = retained_share(p.stiffness, norm(trial), limit)
    z = scale(share, trial)
    f = add_scaled(scale(p.stiffness, z), p.damping, braked(p, x_dot))
    if norm(f) > limit:
        f = scale(limit / norm(f), f)
    put(new.slider, add_scaled(vec(old.slider), 1.0 - share, trial))
    put(new.bristle, z)
    put(new.force, f)
    new.accumulated_slip = old.accumulated_slip + (1.0 - share) * norm(trial)
    out.stored = 0.5 * p.stiffness * dot(z, z)
    out.power = 0.0
    displacement = sub(trial, vec(old.bristle))
    # a sample repeats the last step: its slip is round-off
    out.loss = (
        lost(p.stiffness, vec(old.bristle), z, vec(old.force), f, displacement) if h > 0.0 else 0.0
    )
    put(out.force, scale(-1.0, f))
    out.limit = limit
    out.accumulated_slip = new.accumulated_slip
    push(p, nodes, vec(out.force), d_a, d_b)
    add_stiffness_bound_along(p, nodes, p.first, d_a, d_b, p.stiffness, p.damping)
    if p.second[0] != 0.0 or p.second[1] != 0.0 or p.second[2] != 0.0:
        add_stiffness_bound_along(p, nodes, p.second, d_a, d_b, p.stiffness, p.damping)


@kernel
def braked(p: Parameters, x):
    """Part of a vector (3) in the directions braked, axes of a."""
    first, second = vec(p.first), vec(p.second)
    return add_scaled(scale(dot(first, x), first), dot(second, x), second)


@kernel
def level(p: Parameters, t, curves):
    """F(t) [N]; a negative factor releases the brake."""
    if p.force_curve == 0:
        return p.force
    factor, _, _ = curve_value(curves, p.force_curve, t)
    return p.force * max(factor, 0.0)
