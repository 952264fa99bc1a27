"""Cone of feasible motion of a spherical joint: a direction of b stays within a cone of a.

    e = theta - theta_l(phi),   theta the angle between c and s, phi the azimuth of s about c
    1 / theta_l^2 = f_i + (f_j - f_i) w(sin^2(pi x / 2)) between two azimuths,  w(y) = y^2 (3 - 2 y)
    torque on b: -M grad e,   grad e = t - theta_l' / sin theta (s x t),   t = c x s / sin theta

c and the direction of azimuth 0 are fixed in a, the pointer s in b, and x goes from 0 to 1 between
two azimuths. Four equal half angles are a circular cone; two equal pairs in the ratio 2 are an
elliptic one within 10 % of its half angles. theta_l has three continuous derivatives, so that
moment and stiffness are continuous all round. M is that of `_range.py`, which is the gradient of an
energy where no curve with unloading is given. Consequence to test: without damping any path that
ends within the cone has done no work.

References: Ambrosio (2003), section 5.2; Engin and Tumer (1989), Journal of Biomechanical
Engineering 111, 107-112, of joint sinuses as generalised cones.
"""

from __future__ import annotations

from functools import cache
from math import atan2, floor, pi, sin, sqrt
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity, word
from crashsolve.foundation.angles import check_rotation_limit
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import Vector, add_scaled, cross, dot, norm, put, scale, sub, vec
from crashsolve.springs._joint import named_joint
from crashsolve.springs._range import (
    AT_LIMIT,
    LARGEST,
    MOMENT,
    REACHED,
    RangeCard,
    moment_columns,
    range_event,
    range_moment,
    range_tangent,
)

if TYPE_CHECKING:
    from crashsolve.springs._rows.cone_stop import History, Output, Parameters

LEDGER = "joint"
COUNTS_ROTATIONS = True
MAX_ANGLES = 24  # half angles of one cone
# positions between two azimuths, from 0 to 1: next to a much smaller half angle the limit rises
# within a small share of the way
NEAR = np.geomspace(1e-6, 0.02, 16)
WITHIN = np.concatenate([NEAR, np.linspace(0.03, 0.97, 32), 1.0 - NEAR[::-1]])
# [rad] azimuths nearer than this are one for any joint, and the limit between them is so steep that
# a run would take steps of nanoseconds
NEAREST = 1e-4
# sine below which s lies on the axis and has no azimuth
ON_AXIS = 1e-12


class ConeStop(RangeCard):
    """Cone of feasible motion of a spherical or universal joint."""

    axis: Vec3 = word(
        "axis of the cone, in the frame of the body that carries the cone; any length"
    )
    toward: Vec3 = word("direction of azimuth 0, in the same frame; any that is not along the axis")
    pointer: Vec3 = word("direction kept in the cone, in the frame of the other body; any length")
    carrier: Literal["a", "b"] = word("body of the joint that carries the cone", "a")
    half_angles: tuple[float, float, float, float] | None = quantity(
        "rad",
        "half angles at azimuth 0, 90, 180 and 270 degrees, right-handed about the axis",
        None,
        gt=0,
    )
    table: tuple[tuple[float, float], ...] | None = quantity(
        "rad", "[azimuth, half angle] in order of the azimuth, instead of half_angles", None
    )

    @model_validator(mode="after")
    def _check_cone(self) -> ConeStop:
        if (self.half_angles is None) == (self.table is None):
            raise ValueError("needs one of half_angles and table")
        azimuths = [azimuth for azimuth, _ in self.limits()]
        if not 2 <= len(azimuths) <= MAX_ANGLES:
            raise ValueError(f"table: needs 2 to {MAX_ANGLES} azimuths, has {len(azimuths)}")
        given = "half_angles" if self.table is None else "table"
        if max(half for _, half in self.limits()) > LARGEST:
            raise ValueError(
                f"{given}: half angles must be at most {LARGEST} rad; leave the stop out"
            )
        if min(half for _, half in self.limits()) <= 0.0:
            raise ValueError("table: every half angle must be positive")
        if sorted(set(azimuths)) != azimuths or azimuths[-1] - azimuths[0] >= 2.0 * pi:
            raise ValueError("table: azimuths must rise, within one revolution")
        if np.diff([*azimuths, azimuths[0] + 2.0 * pi]).min() < NEAREST:
            raise ValueError(
                f"table: azimuths must be {NEAREST:g} rad or more apart; the limit cannot jump"
            )
        return self

    def limits(self) -> list[tuple[float, float]]:
        """Azimuth and half angle of every point that the cone goes through [rad]."""
        if self.table is not None:
            return list(self.table)
        return [(0.5 * pi * k, half) for k, half in enumerate(self.half_angles or ())]


PARAMETERS = MOMENT + Record(f"""
    node_a    index     body that carries the cone
    node_b    index     body of the pointer
    reversed  flag      1: the second body of the joint carries the cone
    axis_a    1      3  c, axes of a
    side_a    1      3  direction of azimuth 0, axes of a
    third_a   1      3  c x side, axes of a
    pointer   1      3  s, axes of b
    points    count     of azimuths
    azimuth   rad    {MAX_ANGLES}  rising
    narrow    1      {MAX_ANGLES}  f = 1 / theta_l^2 there
    stretch   1         largest |grad e|^2 at the limit
""")
HISTORY = REACHED
TANGENTS = 1
OUTPUT = Record("""
    torque   N m  M, against the swing
    swing    rad  theta, of the pointer from the axis of the cone
    azimuth  rad  phi, of the pointer
    margin   rad  to the limit; negative past it
    energy   J    stored
    moment   N m  3  on the second body of the joint, its axes
""")


def build(card: ConeStop, scene: Scene) -> Columns:
    joint = named_joint(scene, card.joint, "ball", "swing")
    axis, pointer = scene.unit(card.axis, "axis"), scene.unit(card.pointer, "pointer")
    side = scene.unit(card.toward, "toward")
    side = side - (side @ axis) * axis
    if np.linalg.norm(side) < 1e-6:
        raise scene.fail("must not be along the axis, where there is no azimuth", "toward")
    side = scene.unit(side, "toward")
    azimuth, half = np.array(card.limits()).T
    fill = np.zeros(MAX_ANGLES - len(half))
    ends = (joint.node_a, joint.node_b) if card.carrier == "a" else (joint.node_b, joint.node_a)
    columns = moment_columns(card, scene, "positive") | {
        "node_a": ends[0],
        "node_b": ends[1],
        "reversed": card.carrier == "b",
        "axis_a": axis,
        "side_a": side,
        "third_a": np.cross(axis, side),
        "pointer": pointer,
        "points": len(half),
        "azimuth": np.concatenate([azimuth, fill]),
        "narrow": np.concatenate([half**-2.0, fill]),
    }
    columns["stretch"] = _stretch(tuple(azimuth.tolist()), tuple((half**-2.0).tolist()))
    _check_start(card, scene, columns)
    return columns


@cache
def _stretch(azimuth: tuple[float, ...], narrow: tuple[float, ...]) -> float:
    """Largest 1 + (theta_l' / sin theta)^2 from the limit to half a radian past it."""
    ends = np.r_[azimuth, azimuth[0] + 2.0 * pi]
    around = (ends[:-1, None] + np.diff(ends)[:, None] * WITHIN).ravel().tolist()
    # as plain numbers: numpy takes ten times as long one by one
    limit, slope = np.array([limit_between(azimuth, narrow, len(narrow), phi) for phi in around]).T
    sines = np.sin(np.clip([limit, limit + 0.5], 0.0, 3.0)).min(axis=0)
    return 1.0 + float(((slope / sines) ** 2).max())


def _check_start(card: ConeStop, scene: Scene, p: Columns) -> None:
    """A joint that begins past its cone would be kicked back into it."""
    s = scene.rotation_to_body(p["node_a"], scene.matrix(p["node_b"]) @ p["pointer"])
    across = float(np.hypot(s @ p["side_a"], s @ p["third_a"]))
    theta, phi = atan2(across, s @ p["axis_a"]), atan2(s @ p["third_a"], s @ p["side_a"])
    limit = limit_between(p["azimuth"], p["narrow"], p["points"], phi)[0]
    if theta > limit + AT_LIMIT:
        raise scene.fail(
            f"'{card.joint}' begins at {theta:.4g} rad from the axis, {theta - limit:.3g} rad past "
            f"the limit {limit:.4g} rad at azimuth {phi:.4g} rad; rotate a body, or widen the cone",
            "joint",
        )


class Swing(NamedTuple):
    """Direction of the pointer in the cone."""

    theta: float  # angle from the axis [rad]
    phi: float  # azimuth [rad]
    past: float  # angle past the limit, negative within [rad]
    gradient: Vector  # of `past` over rotations of b, world axes; within the cone that of theta
    cosine: float  # of theta


@kernel
def limit_between(azimuth, narrow, points, phi):
    """theta_l at an azimuth [rad], and its slope [1]."""
    phi -= 2.0 * pi * floor((phi - azimuth[0]) / (2.0 * pi))
    i = 0
    for k in range(1, points):
        if phi >= azimuth[k]:
            i = k
    last = i + 1 == points
    end = azimuth[0] + 2.0 * pi if last else azimuth[i + 1]
    other = narrow[0] if last else narrow[i + 1]
    x = (phi - azimuth[i]) / (end - azimuth[i])
    y = sin(0.5 * pi * x) ** 2
    f = narrow[i] + (other - narrow[i]) * y * y * (3.0 - 2.0 * y)
    rise = 6.0 * y * (1.0 - y) * 0.5 * pi * sin(pi * x) / (end - azimuth[i])
    limit = 1.0 / sqrt(f)
    return limit, -0.5 * limit / f * (other - narrow[i]) * rise


@kernel
def swing_of(p: Parameters, nodes):
    """The Swing of the pointer."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    c, side, third = arm(a, vec(p.axis_a)), arm(a, vec(p.side_a)), arm(a, vec(p.third_a))
    s = arm(b, vec(p.pointer))
    across, cosine = cross(c, s), dot(c, s)
    sine = norm(across)
    theta, phi = atan2(sine, cosine), atan2(dot(s, third), dot(s, side))
    limit, slope = limit_between(p.azimuth, p.narrow, p.points, phi)
    scaled = 1.0 / max(sine, ON_AXIS)
    t = (scaled * across[0], scaled * across[1], scaled * across[2])
    if sine < ON_AXIS:
        t = side
    gradient = add_scaled(t, -slope * scaled, cross(s, t)) if theta > limit else t
    return Swing(theta, phi, theta - limit, gradient, cosine)


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    at = swing_of(p, nodes)
    check_rotation_limit(curves, p.node_b, sqrt(max(0.5 + 0.5 * at.cosine, 0.0)))
    a, b = nodes[p.node_a], nodes[p.node_b]
    rate = dot(at.gradient, sub(vec(b.w), vec(a.w)))
    out.torque = range_moment(p, old, new, out, h, max(at.past, 0.0), rate, curves)
    out.swing, out.azimuth, out.margin = at.theta, at.phi, -at.past
    out.energy = out.stored
    second, moment = (a, out.torque) if p.reversed == 1 else (b, -out.torque)
    put(out.moment, matvec_t(second.A, scale(moment, at.gradient)))
    # counted within the cone as well: nothing else shortens the step before the limit is met
    within = p.stretch if at.past <= 0.0 else 1.0
    stiffness, damping = within * p.largest_slope, within * p.stop_damping
    twist(p, nodes, out.torque, at.gradient, stiffness, damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    at = swing_of(p, nodes)
    rate = dot(at.gradient, sub(vec(b.w), vec(a.w)))
    stiffness, damping = range_tangent(p, state, max(at.past, 0.0), rate, curves)
    rotation_tangent(rows[first], a, b, at.gradient, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance of the swing from the range in which it began the step, within the cone or past
    it [rad].
    """
    at = swing_of(p, nodes)
    rate = dot(at.gradient, sub(vec(nodes[p.node_b].w), vec(nodes[p.node_a].w)))
    return range_event(p, old, h, at.past, rate, curves)
