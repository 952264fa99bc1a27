"""Box: six flat sides that close a volume, their normals outwards.

Consequence to test: the area is 2 (a b + b c + c a), and a pressure all round has no resultant.
"""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.meshes._mesh import Mesh, net, welded


class Box(Card):
    """Closed box with its sides along world axes; sets: x0, x1, y0, y1, z0, z1."""

    at: Vec3 = quantity("m", "corner with the least coordinates", default=(0.0, 0.0, 0.0))
    size: Vec3 = quantity("m", "sides along x, y, z", gt=0)
    elements: tuple[int, int, int] = word("number of elements along x, y, z", ge=1)

    @property
    def count(self) -> int:
        """Number of elements."""
        x, y, z = self.elements
        return 2 * (x * y + y * z + z * x)


def build(card: Box, scene: Scene) -> Mesh:
    points: list[np.ndarray] = []
    quads: list[np.ndarray] = []
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        uv, four, _ = net(card.elements[i], card.elements[j])
        for end in (0.0, 1.0):
            side = np.zeros((len(uv), 3))
            side[:, i], side[:, j], side[:, k] = uv[:, 0], uv[:, 1], end
            # the normal of u x v points along +k: that of the first end is turned round
            quads.append((four if end else four[:, ::-1]) + sum(len(p) for p in points))
            points.append(side)
    unit, corners, _ = welded(np.concatenate(points), np.concatenate(quads))
    sets = {
        f"{'xyz'[k]}{end}": np.flatnonzero(unit[:, k] == float(end))
        for k in range(3)
        for end in (0, 1)
    }
    return Mesh(np.asarray(card.at) + unit * np.asarray(card.size), corners, sets)
