"""Words, parameters and the present vector that a force and a torque on a body share."""

from typing import ClassVar, Literal

from numpy.typing import ArrayLike

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, CurveName, word
from crashsolve.foundation.curve import curve_value
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.motion import arm
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import scale, vec


class BodyLoadCard(Card):
    """Fields of loads on a body: body, axes and factor over time."""

    curve_axes: ClassVar = {"curve": ("s", "1")}

    body: BodyName = word("body that is loaded")
    axes: Literal["world", "body"] = word(
        "axes in which the vector stays constant", default="world"
    )
    curve: CurveName | None = word("factor over time; 1 when absent", default=None)


BODY_LOAD = Record("""
    node     index        body
    vector   N or N m  3  load where the factor is 1
    rotates  flag         the vector is fixed in the body
    curve    index        factor over time; 0 for none
""")


def body_load(card: BodyLoadCard, vector: ArrayLike, scene: Scene) -> Columns:
    """Parameters of a load from the words of its card."""
    if card.body == "ground":
        raise scene.fail("the ground does not move; name a body", "body")
    return {
        "node": scene.node(card.body),
        "vector": vector,
        "rotates": card.axes == "body",
        "curve": scene.curve(card.curve) if card.curve else 0,
    }


@kernel
def present_load(p, t, nodes, curves):
    """The vector [N or N m] in world axes at time t."""
    factor = 1.0
    if p.curve > 0:
        factor, _, _ = curve_value(curves, p.curve, t)
    x = scale(factor, vec(p.vector))
    return arm(nodes[p.node], x) if p.rotates == 1 else x
