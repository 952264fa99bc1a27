"""Linear torsional spring and damper about an axis of a.

    M = k (theta - theta_0) + c theta_dot,   positive rotates b back towards a

theta counts any number of revolutions of b about the axis from the start. The torque acts along the
gradient of theta, so no energy is lost if b tilts. Consequence to test: a disc of inertia J swings
with omega^2 = k / J; stored energy k (theta - theta_0)^2 / 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import quantity
from crashsolve.foundation.angles import ROTATION_ABOUT_AXIS
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import rotation_tangent, twist
from crashsolve.foundation.record import Record
from crashsolve.springs._between import rotated, spring_and_damper
from crashsolve.springs._card import AxisSpringCard

if TYPE_CHECKING:
    from crashsolve.springs._rows.torsional import History, Output, Parameters


class Torsional(AxisSpringCard):
    """Linear torsional spring and damper about an axis of a."""

    stiffness: float = quantity("N m/rad", "slope of torque over angle", ge=0)
    damping: float = quantity("N m s/rad", "torque over rate of the angle", default=0.0, ge=0)
    angle: float = quantity(
        "rad", "rotation from the start at which the torque is zero", default=0.0
    )


COUNTS_ROTATIONS = True
PARAMETERS = ROTATION_ABOUT_AXIS + Record("""
    stiffness  N m/rad    k
    damping    N m s/rad  c
    angle      rad        theta_0
""")
HISTORY = Record("angle  rad  counted rotation")
TANGENTS = 1
OUTPUT = Record("""
    torque  N m    positive rotates b back
    angle   rad    rotation of b from the start
    rate    rad/s  of the angle
""")


def build(card: Torsional, scene: Scene) -> Columns:
    constants = {"stiffness": card.stiffness, "damping": card.damping, "angle": card.angle}
    return scene.rotation_about_axis(card) | constants


@kernel
def force(p: Parameters, old: History, new: History, out: Output, t, h, nodes, rows, curves):
    """Writes: nodes, new, out."""
    angle, rate, g = rotated(p, old.angle, nodes)
    new.angle = angle
    out.torque = spring_and_damper(p, out, angle - p.angle, rate)
    out.angle = angle
    twist(p, nodes, out.torque, g, p.stiffness, p.damping)


@kernel
def tangent(p: Parameters, state: History, nodes, curves, rows, first):
    """Writes: rows."""
    _, _, g = rotated(p, state.angle, nodes)
    rotation_tangent(rows[first], nodes[p.node_a], nodes[p.node_b], g, p.stiffness, p.damping)
