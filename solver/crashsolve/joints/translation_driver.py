"""Slide driver: the travel of b along the axis of a named joint follows a curve of time.

    Phi = axis_a . (x_b - x_a) - x(t),   nu = x'(t),   Phi_tt = -x''(t)     (x: _driven.py)

lambda is the driving force on body b. Consequence to test: a mass driven by f = A sin(omega t)
needs the force -m A omega^2 sin(omega t).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import JointName, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS, named_frame
from crashsolve.joints._constraint_rows import slide_along, slide_jacobian, slide_jacobian_rate
from crashsolve.joints._driven import MOTION, DrivenCard, driven, motion

if TYPE_CHECKING:
    from crashsolve.joints._rows.translation_driver import Parameters

CONSTRAINTS = ()
ROWS = 1
ANGULAR = (False,)
CURVES_OF_TIME = ("curve",)
PARAMETERS = (
    POINTS
    + Record("""
    axis_a  1      3  joint axis, axes of a
""")
    + MOTION
)


class TranslationDriver(DrivenCard):
    """Prescribes the travel of a joint that has one; zero at the start."""

    curve_axes: ClassVar = {
        "curve": ("s", "m"),
        "velocity": ("s", "m/s"),
        "acceleration": ("s", "m/s^2"),
    }

    joint: JointName = word("joint that has a travel: prismatic, cylindrical, ...")


def build(card: TranslationDriver, scene: Scene) -> Columns:
    frame = named_frame(scene, "joint", card.joint, "travel")
    tolerance = scene.deck.control.constraint_tolerance * scene.size
    columns = frame | motion(card, scene, 0.0, slide_rate(frame, scene), tolerance)
    return PARAMETERS.columns_of(columns)


def slide_rate(frame: Columns, scene: Scene) -> float:
    """Rate of the travel at the start [m/s]."""
    (a, A), (b, B) = ((frame[n], scene.matrix(frame[n])) for n in ("node_a", "node_b"))
    s_a, s_b = A @ frame["point_a"], B @ frame["point_b"]
    u, d = A @ frame["axis_a"], scene.r[b] + s_b - scene.r[a] - s_a
    v_a, v_b = (scene.v[n] + np.cross(scene.w[n], s) for n, s in ((a, s_a), (b, s_b)))
    return float(u @ (v_b - v_a) + np.cross(scene.w[a], u) @ d)


@kernel
def residual(p: Parameters, old, new, t, nodes, rows, curves):
    """Writes: rows.phi."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    x, _, _ = driven(p, curves, t)
    travel = slide_along(a, b, p.point_a, p.point_b, p.axis_a)
    rows[p.first_row].phi = travel - x


@kernel
def jacobian(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    _, x_dot, _ = driven(p, curves, t)
    slide_jacobian(a, b, p.point_a, p.point_b, p.axis_a, rows[p.first_row])
    rows[p.first_row].nu = x_dot


@kernel
def convective(p: Parameters, old, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    _, _, x_ddot = driven(p, curves, t)
    convective = slide_jacobian_rate(a, b, p.point_a, p.point_b, p.axis_a)
    rows[p.first_row].gamma = x_ddot - convective
