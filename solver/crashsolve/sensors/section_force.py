"""Section force: force and moment that a joint transmits from a to b, about a point.

    f = sum D_v^T lambda,   m = sum D_w^T lambda + (r_b - x) x f     over the rows of the joint

in the axes of a chosen body, on body b (b minus a). Consequence to test: the joint at the top of a
hanging chain carries the weight of all below it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, JointName, Vec3, quantity, word
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import world_position
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import add, add_scaled, cross, put, sub, vec

if TYPE_CHECKING:
    from crashsolve.sensors._rows.section_force import Output, Parameters

FAMILY = "secforc"


class SectionForce(Card):
    """Force and moment of a joint on its body b, about a point and in the axes of a body."""

    joint: JointName = word("joint that carries the force")
    axes: BodyName = word("body in whose axes force and moment are given", default="ground")
    at: Vec3 | None = quantity(
        "m",
        "point of the moment, in the frame of `axes`; that of the joint when absent",
        default=None,
    )
    role: Literal["neck", "femur_left", "femur_right"] | None = word(
        "part of an occupant whose load it measures, for injury measures: of a neck b of the joint "
        "is the head, whose axes are used; of a femur its a is the thigh",
        default=None,
    )


PARAMETERS = Record("""
    first_row  index     first row of the joint
    rows       count     number of rows
    node_b     index     body b of the joint
    axes       index     body whose axes are used
    holder     index     body that carries the point
    point      m      3  from the mass centre of the holder, its axes
""")
OUTPUT = Record("""
    force   N    3  on b
    moment  N m  3  on b, about the point
""")


def build(card: SectionForce, scene: Scene) -> Columns:
    joint = scene.joints[card.joint]
    if joint.parts > 1:
        raise scene.fail("this joint acts between more than two bodies; name one of two", "joint")
    axes = scene.node(card.axes)
    _check_role(card, scene)
    if card.at is None:
        # a joint without a point acts on the mass centre of b
        holder, point = joint.node_b, joint.frame.get("point_b", np.zeros(3))
    else:
        holder, point = axes, scene.from_mass_centre(axes, card.at)
    return {
        "first_row": joint.first_row,
        "rows": joint.rows,
        "node_b": joint.node_b,
        "axes": axes,
        "holder": holder,
        "point": point,
    }


def _check_role(card: SectionForce, scene: Scene) -> None:
    """Refuse other axes than those in which an injury measure reads the load on body b."""
    if card.role is None:
        return
    joint = scene.joints[card.joint]
    side, what = ("b", "the head") if card.role == "neck" else ("a", "the thigh")
    node = joint.node_b if side == "b" else joint.node_a
    if scene.node(card.axes) != node:
        raise scene.fail(
            f"the role {card.role} reads the load on body b in the axes of {what}, body {side} of "
            f"'{card.joint}': give axes: {scene.names[node]}, or exchange the bodies of the joint",
            "axes",
        )


@kernel
def measure(p: Parameters, out: Output, t, nodes, rows, curves):
    """Writes: out."""
    f, m = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(p.first_row, p.first_row + p.rows):
        D, reaction = rows[k].D, rows[k].reaction
        f = add_scaled(f, reaction, (D[6], D[7], D[8]))
        m = add_scaled(m, reaction, (D[9], D[10], D[11]))
    x = world_position(nodes[p.holder], vec(p.point))
    m = add(m, cross(sub(vec(nodes[p.node_b].r), x), f))
    put(out.force, matvec_t(nodes[p.axes].A, f))
    put(out.moment, matvec_t(nodes[p.axes].A, m))
