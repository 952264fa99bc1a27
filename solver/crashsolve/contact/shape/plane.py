"""Infinite plane fixed in a body; solid behind it, free on the side of its normal."""

from crashsolve.contact.shape._placed import carrier
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.record import Record


class Plane(Card):
    """Infinite plane fixed in a body."""

    body: BodyName = word("body the plane is fixed to", "ground")
    at: Vec3 = quantity("m", "a point of the plane, body axes", default=(0.0, 0.0, 0.0))
    normal: Vec3 = quantity("1", "outward direction, body axes; any length", (0.0, 0.0, 1.0))


PARAMETERS = Record("""
    node    index     body
    point   m      3  point of the plane from the mass centre, body axes
    normal  1      3  outward unit normal, body axes
""")


def build(card: Plane, scene: Scene) -> list[Columns]:
    on = carrier(card.body, scene)
    normal = on.axes @ scene.unit(card.normal, "normal")
    return [{"node": on.node, "point": on.point(card.at), "normal": normal}]


def curvature_radius(card: Plane) -> float | None:
    """Flat."""
    return None
