"""Webbing: force over strain, with a slope of its own on which it unloads to a residual strain.

    eps = l / L - 1,   T = k (eps - s) between 0 and y(eps);   s grows where T reaches y

L is the unstrained length of a segment, l the present one, S = s L its residual elongation. Elastic
energy is L T^2 / 2k. With constant k the losses of a step between T_0 and T_1 are

    (T_0 + T_1) / 2 dS   of webbing drawn out,   and   (T_0 + T_1) / 2 dL + T_0 T_1 dL / 2k

of the flow, summed over segments; with these the energy closes to round-off, whatever the step.
"""

from typing import ClassVar

import numpy as np
from pydantic import model_validator

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, CurveName, quantity, word
from crashsolve.foundation.curve import HOLD, curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.springs._resistance import read, steepest


class Webbing(Card):
    """Force over strain of the webbing, on loading and unloading."""

    curve_axes: ClassVar = {"curve": ("1", "N")}

    stiffness: float | None = quantity("N", "force over strain; or give a curve", None, gt=0)
    curve: CurveName | None = word("force over strain while it grows, from 0", default=None)
    unloading_stiffness: float | None = quantity(
        "N", "k, force over strain on which it unloads; needed with a curve", None, gt=0
    )

    @model_validator(mode="after")
    def _one(self) -> "Webbing":
        if (self.stiffness is None) == (self.curve is None):
            raise ValueError("needs one of stiffness and curve")
        if (self.curve is None) != (self.unloading_stiffness is None):
            raise ValueError("curve and unloading_stiffness belong together")
        return self


WEBBING = Record("""
    k         N      slope of unloading, or stiffness
    curve     index  y; 0 for none
    steepest  N      largest force over strain
""")


def webbing_columns(card: Webbing, scene: Scene) -> Columns:
    """Columns of WEBBING."""
    if card.curve is None:
        return {"k": card.stiffness, "curve": 0, "steepest": card.stiffness}
    k, curve, points = card.unloading_stiffness, scene.curve(card.curve), scene.curve_points
    assert k is not None
    part = points[curve : points[curve]["last"] + 1]
    x = np.linspace(0.0, part["x"][-1], 1001)
    y = read(points, curve, x)
    if part["x"][0] != 0.0 or abs(y[0]) > 1e-12 * np.abs(y).max() or (np.diff(y) <= 0.0).any():
        raise scene.fail("must begin at (0, 0), and rise", "webbing.curve")
    if part["beyond"][0] == HOLD:
        message = (
            "keeps its last value beyond its end, where webbing tears; set extrapolate: refuse "
            "or linear"
        )
        raise scene.fail(message, "webbing.curve")
    if (steep := steepest(points, curve)) >= k:
        message = f"must exceed every slope of the curve; the largest is {steep:g} N"
        raise scene.fail(message, "webbing.unloading_stiffness")
    return {"k": k, "curve": curve, "steepest": k}


def force_at(columns: Columns, strain: float, scene: Scene) -> float:
    """Force of new webbing at a strain [N]."""
    if strain <= 0.0:
        return 0.0
    if not columns["curve"]:
        return float(columns["k"] * strain)
    return float(read(scene.curve_points, columns["curve"], np.array([strain]))[0])


@kernel
def read_beyond_end(p, strain, curves):
    """Reads the curve beyond its end, where the webbing of a segment is. Writes: curves."""
    if strain > curves[curves[p.curve].last].x:
        curve_value(curves, p.curve, strain)


@kernel
def elastic_force(p, length, L):
    """Force [N] of webbing without a curve, and its fall over webbing that flows in [N/m]."""
    if length - L <= 0.0:
        return 0.0, 0.0
    by_L = 1.0 / L
    T = p.k * (length - L) * by_L
    return T, (p.k + T) * by_L


@kernel
def segment_force(p, length, L, S, curves):
    """Force [N], its fall over webbing that flows in [N/m], and growth of S [m]."""
    if length - L - S <= 0.0:
        return 0.0, 0.0, 0.0
    by_L = 1.0 / L
    T = p.k * (length - L - S) * by_L
    softens = (p.k * (1.0 + S * by_L) + T) * by_L
    if p.curve > 0:
        strain = length / L - 1.0
        at = min(strain, curves[curves[p.curve].last].x)
        y, slope, _ = curve_value(curves, p.curve, at)
        y += slope * (strain - at)
        if y < T:
            return y, slope * length / (L * L), length - L - S - L * y / p.k
    return T, softens, 0.0
