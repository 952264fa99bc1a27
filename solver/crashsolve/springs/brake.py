"""Brake between two bodies: a friction force of given level that holds as well as slides.

    f = K z + c z_dot while it holds,  z = s - s_p,   |f| <= F(t);   it slides (s_p follows) at F

s is the displacement of b against a along an axis of a, or in the plane at right angles to it. The
bristle z is elastic and the slider s_p moves only at the limit: what is held does not creep. The
return to the limit and the energy lost are exact for a limit that changes linearly over the step.

Consequence to test: a mass m sliding at v_0 stops after m v_0^2 / 2 F; below F it stays for ever.

Reference: Dahl (1968), A solid friction model, The Aerospace Corporation TOR-0158; with the
elastic-perfectly plastic limit of Simo and Hughes (1998), Computational Inelasticity, 1.2.
"""

from math import sqrt
from typing import Any, Literal

import numpy as np

from crashsolve.deck.card import CurveName, Vec3, quantity, word
from crashsolve.foundation.compile import kernel
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.posture import perpendicular
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, dot, put, scale, sub, vec
from crashsolve.springs._between import POINTS, push, seen_from_a, start_offset, stiffen_along
from crashsolve.springs._card import PointSpringCard

LEDGER = "brake"


class Brake(PointSpringCard):
    """Friction force of given level between two bodies that holds as well as slides."""

    axis: Vec3 = word("direction in the frame of a; any length")
    motion: Literal["along", "across"] = word(
        "which motion is braked: along the axis, or in the plane at right angles", default="along"
    )
    force: float = quantity("N", "level at which it slides; times force_curve", gt=0)
    force_curve: CurveName | None = word("factor on the level over time", default=None)
    stiffness: float = quantity("N/m", "K, of the bristle that holds", gt=0)
    damping: float = quantity("N s/m", "c, of the bristle", default=0.0, ge=0)


PARAMETERS = POINTS + Record(
    first=("1", 3, "first direction braked, axes of a"),
    second=("1", 3, "second direction; 0 when only the first is braked"),
    offset=("m", 3, "b from a at the start, axes of a"),
    force=("N", "F over the factor of the curve"),
    force_curve=("index", "factor over time; 0 for none"),
    stiffness=("N/m", "K"),
    damping=("N s/m", "c"),
)
HISTORY = Record(
    slider=("m", 2, "s_p"),
    stretch=("m", "|z|"),
    limit=("N", "F(t)"),
    slid=("m", "way of the slider"),
)
OUTPUT = Record(
    force=("N", 3, "on b, axes of a"),
    limit=("N", "level at which it slides"),
    slid=("m", "way slid so far"),
)


def build(card: Brake, scene: Any) -> dict[str, Any]:
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
def force(p, old, new, out, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    x, x_dot, d_a, d_b = seen_from_a(p, nodes)
    first, second = vec(p.first), vec(p.second)
    x = sub(x, vec(p.offset))
    z = (dot(first, x) - old.slider[0], dot(second, x) - old.slider[1])
    limit = level(p, t, curves)
    z, slip, loss = hold_or_slide(p.stiffness, z, old.stretch, old.limit, limit)
    # a sample repeats the last step: what it slides is round-off
    out.loss = loss if h > 0.0 else 0.0
    new.slider[0] = dot(first, x) - z[0]
    new.slider[1] = dot(second, x) - z[1]
    new.stretch = sqrt(z[0] * z[0] + z[1] * z[1])
    new.limit = limit
    new.slid = old.slid + slip
    v = (dot(first, x_dot), dot(second, x_dot))
    f = (p.stiffness * z[0] + p.damping * v[0], p.stiffness * z[1] + p.damping * v[1])
    size = sqrt(f[0] * f[0] + f[1] * f[1])
    share = limit / size if size > limit else 1.0
    f = (share * f[0], share * f[1])
    out.stored = 0.5 * p.stiffness * new.stretch**2
    out.power = (f[0] - p.stiffness * z[0]) * v[0] + (f[1] - p.stiffness * z[1]) * v[1]
    put(out.force, add(scale(-f[0], first), scale(-f[1], second)))
    out.limit = limit
    out.slid = new.slid
    push(p, nodes, vec(out.force), d_a, d_b)
    stiffen_along(p, nodes, p.first, d_a, d_b, p.stiffness, p.damping)
    if dot(second, second) > 0.0:
        stiffen_along(p, nodes, p.second, d_a, d_b, p.stiffness, p.damping)


@kernel
def level(p, t, curves):
    """F(t) [N]; a negative factor releases the brake."""
    if p.force_curve == 0:
        return p.force
    factor, _, _ = curve_value(curves, p.force_curve, t)
    return p.force * max(factor, 0.0)


@kernel
def hold_or_slide(stiffness, z, before, limit_before, limit):
    """Bristle after the slider has given way, its way [m] and the energy lost [J].

    `before` and `limit_before` are |z| and the limit at the start of the step; both run linearly to
    their ends, and sliding begins where they meet.
    """
    trial = sqrt(z[0] * z[0] + z[1] * z[1])
    excess = stiffness * trial - limit
    if excess <= 0.0:
        return z, 0.0, 0.0
    room = max(limit_before - stiffness * before, 0.0)
    begin = room / (room + excess)
    slip = excess / stiffness
    mean = 0.5 * (limit_before + begin * (limit - limit_before) + limit)
    share = limit / (stiffness * trial)
    return (share * z[0], share * z[1]), slip, mean * slip
