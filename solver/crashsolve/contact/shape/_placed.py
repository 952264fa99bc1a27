"""Words of shapes that have a centre and axes of their own within a body."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Rotation, Vec3, quantity, word
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


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


class Carrier(NamedTuple):
    """The body that moves by itself and carries a surface, and how the frame of the card lies."""

    node: int
    shift: np.ndarray  # origin of the body that the card names, from the mass centre [m]
    axes: np.ndarray  # (3, 3) its axes in those of the carrier

    def point(self, at: "ArrayLike") -> np.ndarray:
        """A point of the card's frame, from the mass centre of the carrier in its axes [m]."""
        return self.shift + self.axes @ np.asarray(at, float)


def carrier(body: str, scene: Scene) -> Carrier:
    """The carrier of a surface on a body: of one that is part of another, that other."""
    rigid = scene.deck.entries["bodies"].get(body) if scene.welded else None
    if rigid is None or rigid.card.part_of is None:
        node = scene.node(body)
        return Carrier(node, scene.from_mass_centre(node, (0.0, 0.0, 0.0)), np.eye(3))
    part = scene.names.index(body)
    whole = scene.welded[part]
    origin = scene.r[part] - scene.matrix(part) @ scene.offset[part]
    axes = scene.matrix(whole).T @ scene.matrix(part)
    return Carrier(whole, scene.to_body(whole, origin), axes)


def placement(card: PlacedCard, scene: Scene) -> Columns:
    """Columns PLACED of a shape."""
    on = carrier(card.body, scene)
    axes = np.eye(3) if card.rotation is None else matrix(card.rotation.quaternion())
    return {"node": on.node, "point": on.point(card.at), "axes": (on.axes @ axes).ravel()}
