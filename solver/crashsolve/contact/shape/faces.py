"""Faces of a shell as they move and deform: its mid-surface, solid on either side by half of t.

Nodes, balls and ellipsoids press on the nearest face, from whichever side they came.
"""

from typing import Literal

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Card, PartName, quantity, word

GAP_AS = "faces"


class Faces(Card):
    """All faces of a shell part, in contact on both sides."""

    part: PartName = word("shell part whose faces they are")
    thickness: float | None = quantity("m", "t; that of the part if absent", None, gt=0)
    ring: int = word(
        "in contact of a part with itself: rings of faces around a node that it does not touch, in "
        "addition to all faces nearer along the surface than 2.5 times the distance of contact; "
        "0: the faces of the node; 1: their neighbours too; 2: the next",
        default=0,
        ge=0,
        le=20,
    )
    normals: Literal["nearest", "continuous"] = word(
        "direction of the force: from the nearest point, or along a field of normals that is "
        "continuous from face to face",
        default="nearest",
    )


def build(card: Faces, scene: Scene) -> list[Columns]:
    """No elements of its own: those of the part."""
    scene.skin(card.part, "part")
    return []


def curvature_radius(card: Faces) -> float | None:
    """Flat, as far as Hertz's stiffness goes."""
    return None
