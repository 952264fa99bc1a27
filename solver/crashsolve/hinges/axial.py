"""Axial hinge: b slides against a along the beam, and an elastic-plastic force resists.

    F(delta) by _law.py,   delta = axis_a . (x_b - x_a) - delta_0      (Ambrosio (2003), Fig. 3d)

Pull is positive; a curve of its own may describe the push, in which members are crushed. The force
acts in the point of b. Consequence to test: a mass m at V_0 is stopped by a constant force P_s over
the stroke m V_0^2 / 2 P_s.

References: Ambrosio (2003), Eq. 7 and Fig. 3.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity, word
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, axis_tangent, pull, relative
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, cross, dot, sub, vec
from crashsolve.hinges import _single
from crashsolve.hinges._card import AxialCurve, HingeCard, Motion, backbones, law
from crashsolve.hinges._joint import COMMON, LEDGER, at_start, motion_of, release_rows
from crashsolve.hinges._law import LAW, PATH, growth_bound
from crashsolve.joints import prismatic
from crashsolve.joints._card import FRAME
from crashsolve.joints.basic import rows_of

if TYPE_CHECKING:
    from crashsolve.hinges._rows.axial import History, Output, Parameters

__all__ = ["LEDGER", "release_rows"]
CONSTRAINTS, FREE = prismatic.CONSTRAINTS, prismatic.FREE
ROWS, ANGULAR = rows_of(CONSTRAINTS)
TANGENTS = 1
MOTIONS = (Motion("curve", "curve_negative", "stiffness", "initial_stroke", "failure_stroke"),)
curves = partial(backbones, MOTIONS)


class Axial(HingeCard):
    """Axial hinge: b slides along the beam against an elastic-plastic force."""

    curve: AxialCurve = word("force over change of length as it grows, from [0, 0]")
    curve_negative: AxialCurve | None = word(
        "the same for shortening, both counted positive; as curve when absent", default=None
    )
    stiffness: float | None = quantity(
        "N/m", "elastic, also of unloading; the first slope when absent", default=None, gt=0
    )
    initial_stroke: float = quantity(
        "m", "displacement of b from the start at which the hinge has no force", default=0.0
    )
    failure_stroke: float | None = quantity(
        "m", "change of length in either direction at which the hinge fails", default=None, gt=0
    )


PARAMETERS = FRAME + LAW
HISTORY = PATH
OUTPUT = COMMON + Record("""
    force            N    pull is positive
    stroke           m    of b along the axis from the undeformed hinge
    rate             m/s  of the stroke
    plastic_stroke   m    sum of plastic displacements in both directions
    residual_stroke  m    that would be left without force
""")


def build(card: Axial, scene: Scene) -> Columns:
    if card.rate is not None and card.rate.arm is not None:
        raise scene.fail("an axial hinge has no arm: its speed is that of the stroke", "rate.arm")
    return dict(scene.joint_frame(card)) | law(card, MOTIONS, scene)


def initial_history(card: Axial, p: np.void, scene: Scene) -> Columns:
    axis = scene.matrix(p["node_a"]) @ p["axis_a"]
    return at_start(p, float(np.dot(axis, motion_of(scene, p)[0])))


@kernel
def stroke_along(p, nodes, axis):
    """Travel of b along an axis of a [m], its rate, the axis, arms of the force on both bodies."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    d_a, d_b = arm(a, vec(p.point_a)), arm(b, vec(p.point_b))
    x, x_dot = relative(a, d_a, b, d_b)
    u = arm(a, vec(axis))
    rate = dot(u, sub(x_dot, cross(vec(a.w), x)))
    return dot(u, x), rate, u, add(d_a, x), d_b


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    length_change, rate, u, d_a, d_b = stroke_along(p, nodes, p.axis_a)
    x = length_change - p.initial[0]
    pulled, phi = _single.response(p, old, new, out, x, abs(rate), curves)
    out.force, out.stroke, out.rate = pulled, x, rate
    out.plastic_stroke, out.residual_stroke = new.flow[0], new.plastic[0]
    if new.failed == 0:
        drag = growth_bound(p, new.speed) * abs(pulled) / phi
        pull(p, nodes, pulled, u, d_a, d_b, p.stiffness[0], drag)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    length_change, rate, u, d_a, d_b = stroke_along(p, nodes, p.axis_a)
    x = length_change - p.initial[0]
    stiffness, damping = _single.slopes(p, state, x, rate, abs(rate), curves)
    axis_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], u, d_a, d_b, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [m]."""
    length_change, rate, _, _, _ = stroke_along(p, nodes, p.axis_a)
    return _single.beyond(p, old, h, length_change - p.initial[0], rate, abs(rate), curves)
