"""Relative displacement of two points: distance, vector and their rates.

    x = x_b - x_a in world axes,  or  A_a^T (x_b - x_a) as an observer on a measures it

Consequence to test: a point fixed in b beside a turning a has, in the axes of a, the rate -w x x.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.columns import matvec_t
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm, relative
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import cross, dot, norm, put, sub, vec

if TYPE_CHECKING:
    from crashsolve.sensors._rows.displacement import Output, Parameters

FAMILY = "disbout"


class Displacement(Card):
    """Distance of two points of two bodies, and its components."""

    a: BodyName = word("first body", default="ground")
    b: BodyName = word("second body")
    at_a: Vec3 = quantity("m", "point in the frame of a", default=(0.0, 0.0, 0.0))
    at_b: Vec3 = quantity("m", "point in the frame of b", default=(0.0, 0.0, 0.0))
    axes: Literal["world", "a"] = word("axes of the components", default="world")
    role: Literal["chest_deflection", "seat"] | None = word(
        "what it measures of an occupant, for injury measures: chest_deflection from the spine a "
        "to the sternum b, or the distance from the seat a to the pelvis b",
        default=None,
    )


PARAMETERS = Record("""
    node_a       index     first body
    node_b       index     second body
    point_a      m      3  from the mass centre of a, axes of a
    point_b      m      3  from the mass centre of b, axes of b
    is_attached  flag      components in axes of a
    start        m         distance at the start
""")
OUTPUT = Record("""
    distance  m       between the points
    change    m       of the distance since the start
    rate      m/s     of the distance
    vector    m    3  from a to b
    velocity  m/s  3  rate of the vector, in its axes
""")


def build(card: Displacement, scene: Scene) -> Columns:
    ends = scene.attachments(card)
    return ends | {"is_attached": card.axes == "a", "start": scene.distance(ends)}


@kernel
def measure(p: Parameters, out: Output, t, nodes, rows, curves):
    """Writes: out."""
    a, b = nodes[p.node_a], nodes[p.node_b]
    x, x_dot = relative(a, arm(a, vec(p.point_a)), b, arm(b, vec(p.point_b)))
    distance = norm(x)
    out.distance = distance
    out.change = distance - p.start
    # points that coincide have a distance whose rate is not defined
    out.rate = dot(x, x_dot) / distance if distance > 0.0 else 0.0
    if p.is_attached == 1:
        x, x_dot = matvec_t(a.A, x), matvec_t(a.A, sub(x_dot, cross(vec(a.w), x)))
    put(out.vector, x)
    put(out.velocity, x_dot)
