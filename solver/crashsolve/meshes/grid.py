"""Grid: a parallelogram of equal quadrilaterals, or a strip twisted about its length.

    x = at + u along + v across,   u, v in 0 ... 1

`across` turns by `twist` about `along` from u = 0 to u = 1, and the strip stays about its middle
line. Consequence to test: the elements have the area |along x across| together.
"""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.meshes._mesh import Mesh, net


class Grid(Card):
    """Parallelogram; sets of nodes: u0, u1 at the ends of along, v0, v1 at those of across."""

    at: Vec3 = quantity("m", "first corner", default=(0.0, 0.0, 0.0))
    along: Vec3 = quantity("m", "side in direction u")
    across: Vec3 = quantity("m", "side in direction v; the normal is along x across")
    elements: tuple[int, int] = word("number of elements along u and v", ge=1)
    twist: float = quantity("rad", "rotation of across about the middle line", default=0.0)

    @property
    def count(self) -> int:
        """Number of elements."""
        return self.elements[0] * self.elements[1]


def build(card: Grid, scene: Scene) -> Mesh:
    along, across = np.asarray(card.along), np.asarray(card.across)
    if not np.linalg.norm(np.cross(along, across)) > 1e-9 * np.linalg.norm(along) * np.linalg.norm(
        across
    ):
        raise scene.fail("needs two sides that are not parallel", "mesh.across")
    uv, quads, sets = net(*card.elements)
    u, v = uv[:, :1], uv[:, 1:]
    axis = along / np.linalg.norm(along)
    angle = card.twist * u
    rotated = np.cos(angle) * across + np.sin(angle) * np.cross(axis, across)
    rotated += (1.0 - np.cos(angle)) * float(axis @ across) * axis
    points = np.asarray(card.at) + u * along + 0.5 * across + (v - 0.5) * rotated
    return Mesh(points, quads, sets)
