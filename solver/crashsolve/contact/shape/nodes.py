"""Nodes of a flexible part as points or as spheres: all but those welded to rigid bodies.

Those of a shell are points of their own (`foundation/point.py`), met by
`system/contact/node_contact.py`.
"""

from crashsolve.contact.shape import sphere
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, PartName, quantity, word

PARAMETERS, bounding = sphere.PARAMETERS, sphere.bounding
half_thickness, half_width = sphere.half_thickness, sphere.half_width


class Nodes(Card):
    """All nodes of a flexible part, as points or as spheres."""

    part: PartName = word("part whose nodes they are")
    radius: float = quantity("m", "distance of its surface from the nodes", default=0.0, ge=0)


def gap_as(card: Nodes, scene: Scene) -> str:
    """Whose gap routines serve them."""
    return "points" if scene.has_points(card.part) else "sphere"


def build(card: Nodes, scene: Scene) -> list[Columns]:
    if scene.has_points(card.part):
        return []
    nodes = [node for node in scene.part_nodes[card.part] if node not in scene.welded]
    if not nodes:
        raise scene.fail(
            "all its nodes are welded to rigid bodies; use a point_set on these", "part"
        )
    return [{"node": node, "point": (0.0, 0.0, 0.0), "radius": card.radius} for node in nodes]


def curvature_radius(card: Nodes) -> float | None:
    """Radius for Hertz's stiffness [m]; points are sharp: it does not exist."""
    return card.radius
