"""Strut between two points: spring, damper of its own in bump and rebound, and stops at both ends.

    F = y(x) + D(l_dot) - B(l_b - l) + R(l - l_r),   x = l - l_0,   tension positive
    B acts below the length l_b (bump), R above l_r (rebound); neither holds the ends together

D is c_b l_dot in bump (shorter) and c_r l_dot in rebound (longer), or a curve that never drives.
Consequence to test: a stroke of amplitude A and angular frequency omega loses
pi omega A^2 (c_b + c_r) / 2 in a cycle; a mass that meets the bump stop k_b at v goes
sqrt(m / k_b) v beyond it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import CurveName, quantity, word
from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import line_tangent, pull
from crashsolve.foundation.record import Record
from crashsolve.springs._between import POINTS, line_of_action, rest_length
from crashsolve.springs._card import PointSpringCard
from crashsolve.springs._geometric_stiffness import add_geometric_stiffness
from crashsolve.springs._resistance import read, steepest

if TYPE_CHECKING:
    from crashsolve.springs._rows.strut import History, Output, Parameters

# positions where the sign of a cubic of a damper is checked
PARTS = np.linspace(0.0, 1.0, 17)


class Strut(PointSpringCard):
    """Spring, damper with two sides, bump stop and rebound stop between two points."""

    curve_axes: ClassVar = {
        "curve": ("m", "N"),
        "damping_curve": ("m/s", "N"),
        "bump_curve": ("m", "N"),
        "rebound_curve": ("m", "N"),
    }

    stiffness: float | None = quantity("N/m", "stiffness of the spring", default=None, ge=0)
    curve: CurveName | None = word(
        "y, force over the change of length; instead of stiffness", default=None
    )
    length: float | None = quantity(
        "m", "l_0, at which the spring is free; that at the start when absent", default=None, ge=0
    )
    bump_damping: float = quantity("N s/m", "c_b, in compression", default=0.0, ge=0)
    rebound_damping: float = quantity("N s/m", "c_r, in extension", default=0.0, ge=0)
    damping_curve: CurveName | None = word(
        "D, force over the rate of length, negative in bump; instead of both dampings", default=None
    )
    bump_length: float | None = quantity(
        "m", "l_b, length at which the bump stop is reached", default=None, gt=0
    )
    bump_stiffness: float | None = quantity("N/m", "stiffness of the bump stop", default=None, gt=0)
    bump_curve: CurveName | None = word(
        "B, force over the travel beyond it, from 0; instead of bump_stiffness", default=None
    )
    rebound_length: float | None = quantity(
        "m", "l_r, length at which the rebound stop is reached", default=None, gt=0
    )
    rebound_stiffness: float | None = quantity(
        "N/m", "stiffness of the rebound stop", default=None, gt=0
    )
    rebound_curve: CurveName | None = word(
        "R, force over the travel beyond it, from 0; instead of rebound_stiffness", default=None
    )

    @model_validator(mode="after")
    def _consistent(self) -> Strut:
        if (self.stiffness is None) == (self.curve is None):
            raise ValueError("needs one of stiffness and curve")
        if self.damping_curve and (self.bump_damping or self.rebound_damping):
            raise ValueError("damping_curve: takes the place of bump_damping and rebound_damping")
        for stop in ("bump", "rebound"):
            length, stiffness, curve = (
                getattr(self, f"{stop}_{word}") for word in ("length", "stiffness", "curve")
            )
            if length is None and (stiffness is not None or curve is not None):
                raise ValueError(
                    f"{stop}_length: is missing, the length at which the stop is reached"
                )
            if length is not None and (stiffness is None) == (curve is None):
                raise ValueError(f"needs one of {stop}_stiffness and {stop}_curve")
        bump, rebound = self.bump_length, self.rebound_length
        if bump is not None and rebound is not None and bump > rebound:
            raise ValueError("bump_length: must not exceed rebound_length")
        return self


PARAMETERS = POINTS + Record("""
    length             m      l_0
    stiffness          N/m    of the spring; not used with a curve
    curve              index  y; 0 for none
    bump_damping       N s/m  c_b
    rebound_damping    N s/m  c_r
    damping_curve      index  D; 0 for none
    bump_length        m      l_b; minus infinity for none
    bump_stiffness     N/m    of the bump stop
    bump_curve         index  B; 0 for none
    rebound_length     m      l_r; infinity for none
    rebound_stiffness  N/m    of the rebound stop
    rebound_curve      index  R; 0 for none
    largest_slope      N/m    largest slope of spring and stop together
    largest_damping       N s/m  largest slope of the damper
""")
HISTORY = Record()
TANGENTS = 1
OUTPUT = Record("""
    force    N    tension positive
    spring   N    part of the spring
    damper   N    part of the damper
    stop     N    part of the stops
    length   m    present length
    rate     m/s  of the length
""")


def build(card: Strut, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    curves = {
        name: scene.curve(getattr(card, name)) if getattr(card, name) else 0
        for name in Strut.curve_axes
    }
    for name in ("bump_curve", "rebound_curve"):
        _check_stop(name, curves[name], scene)
    _check_damper(curves["damping_curve"], scene)
    own = {
        "length": rest_length(card, scene, ends),
        "stiffness": card.stiffness or 0.0,
        "bump_damping": card.bump_damping,
        "rebound_damping": card.rebound_damping,
        "bump_length": float("-inf") if card.bump_length is None else card.bump_length,
        "bump_stiffness": card.bump_stiffness or 0.0,
        "rebound_length": float("inf") if card.rebound_length is None else card.rebound_length,
        "rebound_stiffness": card.rebound_stiffness or 0.0,
    }
    points = scene.curve_points

    def slope(name: str, *others: str) -> float:
        """Largest slope of a curve, or the constant in its place [N/m or N s/m]."""
        return steepest(points, curves[name]) if curves[name] else max(own[k] for k in others)

    stops = [slope("bump_curve", "bump_stiffness"), slope("rebound_curve", "rebound_stiffness")]
    own["largest_slope"] = slope("curve", "stiffness") + max(stops)
    own["largest_damping"] = slope("damping_curve", "bump_damping", "rebound_damping")
    return ends | curves | own


def _check_stop(name: str, curve: int, scene: Scene) -> None:
    """Raises a refusal unless the force of a stop begins at 0 and pushes."""
    if not curve:
        return
    x, y = _samples(curve, scene)
    if x[0] != 0.0 or y[0] != 0.0:
        raise scene.fail("must begin at (0, 0), where the stop is met", name)
    if y.min() < 0.0:
        raise scene.fail(f"must not fall below 0, as at {x[y.argmin()]:g} m: a stop pushes", name)


def _check_damper(curve: int, scene: Scene) -> None:
    """Raises a refusal where the force of a damper would drive."""
    if not curve:
        return
    rate, force = _samples(curve, scene)
    if not rate[0] <= 0.0 <= rate[-1]:
        raise scene.fail("must reach from bump (negative rates) to rebound", "damping_curve")
    rate, force = (
        np.append(rate, 0.0),
        np.append(force, read(scene.curve_points, curve, np.zeros(1))),
    )
    # round-off of an interpolation through 0
    driving = force * rate < 0.0
    driving |= (rate == 0.0) & (np.abs(force) > 1e-12 * np.abs(force).max())
    if driving.any():
        at = np.flatnonzero(driving)[0]
        raise scene.fail(
            f"drives at {rate[at]:g} m/s, where it is {force[at]:g} N; a damper has the sign of "
            "the rate, and no force at 0",
            "damping_curve",
        )


def _samples(curve: int, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """A curve at its points and between them."""
    points = scene.curve_points
    x = points["x"][curve : points[curve]["last"] + 1]
    x = np.append((x[:-1, None] + np.diff(x)[:, None] * PARTS[:-1]).ravel(), x[-1])
    return x, read(points, curve, x)


@kernel
def elastic(curves, curve, stiffness, x):
    """Force [N], slope [N/m] and stored energy [J] of a spring."""
    if curve > 0:
        f, slope, _ = curve_value(curves, curve, x)
        return f, slope, curve_area(curves, curve, x) - curve_area(curves, curve, 0.0)
    return stiffness * x, stiffness, 0.5 * stiffness * x * x


@kernel
def damped(p: Parameters, rate, curves):
    """Force of the damper [N] and its slope [N s/m]."""
    if p.damping_curve > 0:
        f, slope, _ = curve_value(curves, p.damping_curve, rate)
        return f, slope
    c = p.bump_damping if rate < 0.0 else p.rebound_damping
    return c * rate, c


@kernel
def stopped(p: Parameters, length, curves):
    """Force of the stops, tension positive [N], slope [N/m] and stored energy [J]."""
    if length < p.bump_length:
        f, k, e = elastic(curves, p.bump_curve, p.bump_stiffness, p.bump_length - length)
        return -f, k, e
    if length > p.rebound_length:
        return elastic(curves, p.rebound_curve, p.rebound_stiffness, length - p.rebound_length)
    return 0.0, 0.0, 0.0


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, out."""
    u, length, rate, d_a, d_b = line_of_action(p, nodes)
    spring, _, stored = elastic(curves, p.curve, p.stiffness, length - p.length)
    damper, _ = damped(p, rate, curves)
    stop, _, pressed = stopped(p, length, curves)
    out.spring, out.damper, out.stop = spring, damper, stop
    out.force = spring + damper + stop
    out.length, out.rate = length, rate
    out.stored = stored + pressed
    out.power = damper * rate
    out.loss = 0.0
    pull(p, nodes, out.force, u, d_a, d_b, p.largest_slope, p.largest_damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    line = line_of_action(p, nodes)
    _, k, _ = elastic(curves, p.curve, p.stiffness, line.length - p.length)
    _, stop, _ = stopped(p, line.length, curves)
    _, c = damped(p, line.rate, curves)
    line_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], line, k + stop, c)


geometric_stiffness = add_geometric_stiffness
