"""Gear: the angles of two named joints turn in a fixed ratio.

    Phi = theta_2 - ratio theta_1 = 0      (angles since the start, over all revolutions)

The row has two parts, one per joint; its torques act between the bodies of each joint, so that a
housing receives the difference. Consequence to test: a torque T on wheel 1 turns both wheels with
theta_1_ddot = T / (J_1 + ratio^2 J_2).
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
from crashsolve.joints._constraint_rows import rotation_jacobian, scale_row

if TYPE_CHECKING:
    from crashsolve.joints._rows.gear import History, Parameters

COUNTS_ROTATIONS = True
CONSTRAINTS = ()
ROWS = 1
ANGULAR = (True,)
FURTHER_NODES = ("node_c", "node_d")
PARAMETERS = ROTATION_ABOUT_AXIS + Record("""
    node_c  index     body a of the second joint
    node_d  index     body b of the second joint
    axis_c  1      3  axis of the second joint, axes of its a
    side_c  1      3  from which its angle counts, axes of its a
    side_d  1      3  to which its angle counts, axes of its b
    ratio   1         angle of the second over angle of the first
""")
HISTORY = Record("""
    first   rad  angle of the first joint, over all revolutions
    second  rad  angle of the second joint, over all revolutions
""")


class Gear(Card):
    """Couples the angles of two joints that have one, such as revolute ones."""

    first: JointName = word("joint that has an angle: revolute, cylindrical, ...")
    second: JointName = word("joint that has an angle: revolute, cylindrical, ...")
    ratio: float = quantity(
        "1", "rotation of the second over that of the first; negative for opposite directions"
    )


def build(card: Gear, scene: Scene) -> Columns:
    if card.first == card.second:
        raise scene.fail("couples a joint with itself; name another", "second")
    if card.ratio == 0.0:
        raise scene.fail("must not be 0", "ratio")
    one = named_frame(scene, "first", card.first, "angle")
    two = named_frame(scene, "second", card.second, "angle")
    columns = ROTATION_ABOUT_AXIS.columns_of(one)
    columns |= {"node_c": two["node_a"], "node_d": two["node_b"], "axis_c": two["axis_a"]}
    return columns | {"side_c": two["side_a"], "side_d": two["side_b"], "ratio": card.ratio}


@kernel
def residual(p: Parameters, old: History, new: History, t, nodes, rows, curves):
    """Writes: rows.phi, new."""
    first = angle_about(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_a, p.side_b)
    second = angle_about(nodes[p.node_c], nodes[p.node_d], p.axis_c, p.side_c, p.side_d)
    new.first = counted(first, old.first)
    new.second = counted(second, old.second)
    rows[p.first_row].phi = new.second - p.ratio * new.first


@kernel
def jacobian(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.D, nu."""
    r = p.first_row
    rotation_jacobian(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b, rows[r])
    scale_row(rows[r], -p.ratio)
    rotation_jacobian(nodes[p.node_c], nodes[p.node_d], p.axis_c, p.side_d, rows[r + 1])


@kernel
def convective(p: Parameters, old: History, t, nodes, rows, curves):
    """Writes: rows.gamma."""
    first = angle_jacobian_rate(nodes[p.node_a], nodes[p.node_b], p.axis_a, p.side_b)
    second = angle_jacobian_rate(nodes[p.node_c], nodes[p.node_d], p.axis_c, p.side_d)
    rows[p.first_row].gamma = p.ratio * first - second
