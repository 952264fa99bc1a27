"""Sphere fixed in a body."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crashsolve.contact.shape._placed import carrier
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Sphere(Card):
    """Sphere fixed in a body."""

    body: BodyName = word("body the sphere is fixed to", "ground")
    at: Vec3 = quantity("m", "centre, body axes", default=(0.0, 0.0, 0.0))
    radius: float = quantity("m", "radius", gt=0)


PARAMETERS = Record("""
    node    index     body
    point   m      3  centre from the mass centre, body axes
    radius  m         radius
""")


def build(card: Sphere, scene: Scene) -> list[Columns]:
    on = carrier(card.body, scene)
    return [{"node": on.node, "point": on.point(card.at), "radius": card.radius}]


def curvature_radius(card: Sphere) -> float | None:
    """Radius for Hertz's stiffness [m]; None where the surface is flat."""
    return card.radius


def bounding(element: Columns) -> tuple[ArrayLike, float]:
    """Centre (3,) [m] in body axes and radius [m] of the smallest enclosing sphere."""
    return element["point"], float(element["radius"])


def half_thickness(element: Columns) -> float:
    """Radius, the depth of the middle [m]."""
    return float(element["radius"])


def half_width(element: Columns) -> float:
    """Radius [m]."""
    return float(element["radius"])
