"""Damper between two points whose force follows a curve over the rate of its length.

    F = c(l_dot),   tension positive;   v c(v) >= 0

A damper with one constant to lengthen and another to shorten is a curve of two straight lines.
Steps of Runge-Kutta methods end at its corners. Consequence to test: with constants c_1 lengthening
and c_2 shortening a free mass m stops after a travel of m v / c_1 or m v / c_2; all of its
energy is dissipated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import CurveName, word
from crashsolve.foundation.curve import LINEAR, curve_value, segment
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import line_tangent, pull
from crashsolve.foundation.record import Record
from crashsolve.springs._between import POINTS, line_of_action
from crashsolve.springs._card import PointSpringCard
from crashsolve.springs._geometric_stiffness import add_geometric_stiffness
from crashsolve.springs._resistance import steepest

if TYPE_CHECKING:
    from crashsolve.springs._rows.damper import History, Output, Parameters


class Damper(PointSpringCard):
    """Damper between two points whose force follows a curve over the rate of its length."""

    curve_axes: ClassVar = {"curve": ("m/s", "N")}

    curve: CurveName = word("force over rate, both positive as it lengthens; through (0, 0)")


PARAMETERS = POINTS + Record("""
    curve     index   c
    largest_slope  N s/m   largest slope of the curve
""")
HISTORY = Record("segment  index  of the curve that is read")
TANGENTS = 1
OUTPUT = Record("""
    force   N    tension positive
    length  m    present length
    rate    m/s  of the length
""")


def build(card: Damper, scene: Scene) -> Columns:
    curve = scene.curve(card.curve)
    _check(scene.curve_points, curve, card.curve, scene)
    stiffest = steepest(scene.curve_points, curve)
    return scene.attachments(card) | {"curve": curve, "largest_slope": stiffest}


def _check(points: np.ndarray, start: int, name: str, scene: Scene) -> None:
    """Refuse a curve that is not 0 at rest, or that drives instead of damping."""
    part = points[start : points[start]["last"] + 1]
    # a cubic is checked between its points as well
    s = np.diff(part["x"])[:, None] * np.linspace(0.0, 1.0, 33)
    c0, c1, c2, c3 = part["c"][:-1].T[:, :, None]
    rate, force = part["x"][:-1, None] + s, c0 + s * (c1 + s * (c2 + s * c3))
    at_rest = np.flatnonzero(part["x"] == 0.0)
    if not at_rest.size or abs(np.interp(0.0, rate.ravel(), force.ravel())) > 0.0:
        raise scene.fail(f"curve '{name}' must have the point (0, 0): no force at rest", "curve")
    continued = part["beyond"][0] == LINEAR
    slope = c1 + s * (2.0 * c2 + 3.0 * s * c3)
    if continued and min(slope[0, 0], slope[-1, -1]) < 0.0:
        raise scene.fail(
            f"curve '{name}' falls at an end and is continued straight, so that it drives far "
            "beyond; let it end level, or write extrapolate: hold",
            "curve",
        )
    if (rate * force).min() < 0.0:
        worst = rate.ravel()[(rate * force).argmin()]
        raise scene.fail(
            f"curve '{name}' adds energy at {worst:.6g} m/s instead of dissipating it; force "
            "and rate must have the same sign",
            "curve",
        )


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    u, length, rate, d_a, d_b = line_of_action(p, nodes)
    tension, _, _ = curve_value(curves, p.curve, rate)
    new.segment = segment(curves, p.curve, curves[p.curve].last, rate)
    out.force = tension
    out.length = length
    out.rate = rate
    out.stored = out.loss = 0.0
    out.power = tension * rate
    pull(p, nodes, tension, u, d_a, d_b, 0.0, p.largest_slope)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    line = line_of_action(p, nodes)
    _, slope, _ = curve_value(curves, p.curve, line.rate)
    line_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], line, 0.0, slope)


geometric_stiffness = add_geometric_stiffness


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance of the rate beyond the piece of the curve on which the step began, over h [m]."""
    _, _, rate, _, _ = line_of_action(p, nodes)
    first, last = old.segment, curves[p.curve].last
    low = curves[first].x if first > p.curve else -1e300
    high = curves[first + 1].x if first + 1 < last else 1e300
    return max(low - rate, rate - high) * h
