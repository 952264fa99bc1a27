"""Rack and pinion: the travel of one named joint is the angle of another times the radius.

    Phi = x - R theta = 0      (travel and angle since the start, over all revolutions)

The row has two parts, one per joint. Consequence to test: a rack of mass m that falls while it
turns a pinion of inertia J accelerates with m g / (m + J / R^2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, JointName, quantity, word
from crashsolve.foundation.angles import (
    ROTATION_ABOUT_AXIS,
    angle_about,
    angle_jacobian_rate,
    counted,
)
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.joints._card import named_frame
from crashsolve.joints._constraint_rows import (
    rotation_jacobian,
    scale_row,
    slide_along,
    slide_jacobian,
    slide_jacobian_rate,
)

if TYPE_CHECKING:
    from crashsolve.joints._rows.rack import History, Parameters

COUNTS_ROTATIONS = True
CONSTRAINTS = ()
ROWS = 1
ANGULAR = (False,)
FURTHER_NODES = ("node_c", "node_d")
PARAMETERS = ROTATION_ABOUT_AXIS + Record("""
    node_c   index     body a of the rack's joint
    node_d   index     body b of the rack's joint
    point_c  m      3  point of the rack's joint from the mass centre of its a, axes of its a
    point_d  m      3  point of the rack's joint from the mass centre of its b, axes of its b
    axis_c   1      3  axis of the rack's joint, axes of its a
    radius   m         R
""")
HISTORY = Record("angle  rad  angle of the pinion, over all revolutions")


class Rack(Card):
    """Couples the travel of a joint to the angle of a pinion's joint."""

    pinion: JointName = word("joint of the pinion, which has an angle: revolute, ...")
    rack: JointName = word("joint of the rack, which has a travel: prismatic, ...")
    radius: float = quantity(
        "m", "pitch radius; negative when the rack moves in the opposite direction"
    )


def build(card: Rack, scene: Scene) -> Columns:
    if card.radius == 0.0:
        raise scene.fail("must not be 0", "radius")
    one = named_frame(scene, "pinion", card.pinion, "angle")
    two = named_frame(scene, "rack", card.rack, "travel")
    columns = ROTATION_ABOUT_AXIS.columns_of(one)
    columns |= {"node_c": two["node_a"], "node_d": two["node_b"], "axis_c": two["axis_a"]}
    columns |= {"point_c": two["point_a"], "point_d": two["point_b"], "radius": card.radius}
    return columns


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi, new."""
    angle = angle_about(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_a, p.side_b)
    new.angle = counted(angle, old.angle)
    travel = slide_along(nodes[p.node_c], nodes[p.node_d], p.point_c, p.point_d, p.axis_c)
    rows[p.first_row].phi = travel - p.radius * new.angle


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    r, c, d = p.first_row, nodes[p.node_c], nodes[p.node_d]
    rotation_jacobian(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b, rows[r])
    scale_row(rows[r], -p.radius)
    slide_jacobian(c, d, p.point_c, p.point_d, p.axis_c, rows[r + 1])


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    convective = angle_jacobian_rate(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b)
    sliding = slide_jacobian_rate(nodes[p.node_c], nodes[p.node_d], p.point_c, p.point_d, p.axis_c)
    rows[p.first_row].gamma = p.radius * convective - sliding
