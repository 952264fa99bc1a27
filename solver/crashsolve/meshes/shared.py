"""Shared mesh: elements of a mesh of the deck, whose nodes other parts have too.

Parts that name one mesh are joined at the nodes that they have in common, without any further
card. Consequence to test: a plate of two parts with equal data moves as the plate of one part.
"""

from pydantic import model_validator

from crashsolve.deck.building import MeshOfScene, Scene
from crashsolve.deck.card import Card, MeshName, SetName, Vec3, quantity, word


class Shared(Card):
    """Elements of a mesh under `meshes`: of a set, or with their middles in a box, or all."""

    mesh: MeshName = word("mesh under meshes")
    elements: SetName = word("element set of this mesh", default="")
    low: Vec3 | None = quantity(
        "m", "or corner of a box with the least coordinates, in place of elements", default=None
    )
    high: Vec3 | None = quantity(
        "m", "corner of the box with the largest coordinates", default=None
    )

    @model_validator(mode="after")
    def _one(self) -> "Shared":
        if (self.low is None) != (self.high is None):
            raise ValueError("low and high belong together")
        if self.elements and self.low is not None:
            raise ValueError("give elements, or low and high")
        return self


def build(card: Shared, scene: Scene) -> MeshOfScene:
    return scene.own_share()
