"""Words of shapes that have a centre and axes of their own within a body."""

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Rotation, Vec3, quantity, word
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.record import Record


class PlacedCard(Card):
    """Body, centre and orientation of a shape."""

    body: BodyName = word("body the shape is fixed to", "ground")
    at: Vec3 = quantity("m", "centre, body axes", (0.0, 0.0, 0.0))
    rotation: Rotation | None = word("orientation of the shape in the body", None)


PLACED = Record("""
    node   index     body
    point  m      3  centre from the mass centre, body axes
    axes   1      9  rotation matrix, shape to body, by rows
""")


def placement(card: PlacedCard, scene: Scene) -> Columns:
    """Columns PLACED of a shape."""
    node = scene.node(card.body)
    axes = np.eye(3) if card.rotation is None else matrix(card.rotation.quaternion())
    return {"node": node, "point": scene.from_mass_centre(node, card.at), "axes": axes.ravel()}
