"""Points fixed in a body: spheres of radius 0."""

from crashsolve.contact.shape import sphere
from crashsolve.contact.shape._placed import carrier
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word

GAP_AS = "sphere"
PARAMETERS, bounding = sphere.PARAMETERS, sphere.bounding
half_thickness, half_width = sphere.half_thickness, sphere.half_width


class PointSet(Card):
    """Points fixed in a body."""

    body: BodyName = word("body the points are fixed to", "ground")
    points: tuple[Vec3, ...] = quantity("m", "points, body axes")


def build(card: PointSet, scene: Scene) -> list[Columns]:
    if not card.points:
        raise scene.fail("needs at least one point", "points")
    on = carrier(card.body, scene)
    return [{"node": on.node, "point": on.point(at), "radius": 0.0} for at in card.points]


def curvature_radius(card: PointSet) -> float | None:
    """Sharp: Hertz's stiffness does not exist."""
    return 0.0
