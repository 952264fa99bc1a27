"""Angle of rotation of b about an axis of a, counted over any number of revolutions.

    theta and theta_dot as in foundation.turn; 0 at the start

Revolutions are counted at every step, not only at samples. Consequence to test: a body that spins
at w for a time t shows w t, however many revolutions that is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, word
from crashsolve.foundation.angles import ROTATION_ABOUT_AXIS, angle_about, angle_rate, counted
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from crashsolve.sensors._rows.angle import History, Output, Parameters

FAMILY = "disbout"


class Angle(Card):
    """Angle of rotation of b about an axis of a, counted over all revolutions."""

    a: BodyName = word("first body; it carries the axis", default="ground")
    b: BodyName = word("second body")
    axis: Vec3 = word("direction of the axis in the frame of a; any length")


COUNTS_ROTATIONS = True
PARAMETERS = ROTATION_ABOUT_AXIS
HISTORY = Record("angle  rad  counted rotation")
OUTPUT = Record("""
    angle  rad    rotation of b from the start
    rate   rad/s  of the angle
""")


def build(card: Angle, scene: Scene) -> Columns:
    return dict(scene.rotation_about_axis(card))


@kernel
def follow(p: Parameters, old: History, new: History, out: Output, nodes):
    """Count the rotation. Writes: new, out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    new.angle = counted(angle_about(a, b, p.axis_a, p.side_a, p.side_b), old.angle)
    out.angle = new.angle


@kernel
def measure(p: Parameters, out: Output, t, nodes, rows, curves):
    """Writes: out."""
    out.rate = angle_rate(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b)
