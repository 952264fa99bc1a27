"""Listed mesh: nodes and quadrilaterals one by one, for a handful of elements.

Consequence to test: the nodes are where the deck puts them.
"""

from typing import Literal

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, SetName, Vec3, quantity, word
from crashsolve.meshes._joined import coarsened
from crashsolve.meshes._mesh import Mesh


class NodeSet(Card):
    """Named set of nodes."""

    name: SetName = word("name of the set, or its number")
    nodes: tuple[int, ...] = word("numbers of the nodes, from 1", ge=1)


class Listed(Card):
    """Mesh given by lists of its nodes and elements."""

    nodes: tuple[Vec3, ...] = quantity("m", "positions; numbered from 1")
    quads: tuple[tuple[int, int, int, int], ...] = word(
        "four nodes each, counter-clockwise seen from outside; a triangle names its last one twice",
        ge=1,
    )
    sets: tuple[NodeSet, ...] = word("sets of nodes", default=())
    joined: Literal[1, 2, 4, 8] = word(
        "number of elements along each side that become one, where they lie in rows", default=1
    )

    @property
    def count(self) -> int:
        """Number of elements."""
        return max(len(self.quads) // self.joined**2, 1)


def build(card: Listed, scene: Scene) -> Mesh:
    points, quads = np.asarray(card.nodes, float), np.asarray(card.quads, np.int64) - 1
    if not quads.size:
        raise scene.fail("needs an element at least", "mesh.quads")
    if quads.max() >= len(points):
        message = f"there is no node {quads.max() + 1}; {len(points)} are listed"
        raise scene.fail(message, "mesh.quads")
    sets = {}
    for k, own in enumerate(card.sets):
        sets[own.name] = np.asarray(own.nodes, np.int64) - 1
        if sets[own.name].max(initial=-1) >= len(points):
            raise scene.fail(f"names a node beyond {len(points)}", f"mesh.sets.{k}.nodes")
    return coarsened(Mesh(points, quads, sets), card, scene)
