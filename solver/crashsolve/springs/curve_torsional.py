"""Torsional spring about an axis of a whose torque follows a curve.

    M = f(theta - theta_0),   positive rotates b back, with f as in springs._resistance

Consequence to test: with `unloading_stiffness` k a rotation theta leaves theta - f(theta) / k.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity, word
from crashsolve.foundation.angles import ROTATION_ABOUT_AXIS
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.springs import _resistance
from crashsolve.springs._between import rotated
from crashsolve.springs._card import AxisSpringCard, ResistanceCard

if TYPE_CHECKING:
    from crashsolve.springs._rows.curve_torsional import History, Output, Parameters


class CurveTorsional(AxisSpringCard, ResistanceCard):
    """Torsional spring about an axis of a whose torque follows a curve."""

    curve_axes: ClassVar = {
        "curve": ("rad", "N m"),
        "unloading_curve": ("rad", "N m"),
        "rate_curve": ("rad/s", "1"),
    }

    angle: float = quantity("rad", "rotation from the start at which it is undeformed", default=0.0)
    unloading_stiffness: float | None = quantity(
        "N m/rad",
        "slope on which the torque falls and grows again; leaves a permanent set",
        default=None,
        gt=0,
    )
    acts: Literal["both", "positive", "negative"] = word(
        "directions of rotation that are resisted", default="both"
    )
    gap: float = quantity("rad", "free play in each direction", default=0.0, ge=0)
    damping: float = quantity("N m s/rad", "torque over rate", default=0.0, ge=0)


COUNTS_ROTATIONS = True
PARAMETERS = ROTATION_ABOUT_AXIS + _resistance.RESISTANCE + Record("angle  rad  theta_0")
HISTORY = _resistance.SLIDER + Record("angle  rad  counted rotation")
TANGENTS = 1
OUTPUT = Record("""
    torque  N m    positive rotates b back
    angle   rad    rotation of b from the start
    rate    rad/s  of the angle
    set     rad    permanent rotation, the larger of both directions
""")


def build(card: CurveTorsional, scene: Scene) -> Columns:
    return (
        scene.rotation_about_axis(card)
        | _resistance.resistance(card, scene)
        | {"angle": card.angle}
    )


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, rate, g = rotated(p, old.angle, nodes)
    new.angle = angle
    x = angle - p.angle
    torque, stiffness, damping = _resistance.resistance_force(p, old, new, out, h, x, rate, curves)
    out.torque = torque
    out.angle = angle
    out.rate = rate
    out.set = new.set[0] if new.set[0] >= new.set[1] else -new.set[1]
    twist(p, nodes, torque, g, stiffness, damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    angle, rate, g = rotated(p, state.angle, nodes)
    stiffness, damping = _resistance.resistance_tangent(p, state, angle - p.angle, rate, curves)
    rotation_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], g, stiffness, damping)


@kernel
def event(p: Parameters, old: History, h, nodes, curves):
    """Distance beyond the branch of the law on which the step began [rad]."""
    angle, rate, _ = rotated(p, old.angle, nodes)
    return _resistance.branch_event(p, old, h, angle - p.angle, rate, curves)
