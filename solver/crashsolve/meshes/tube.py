"""Tube of rectangular section: four flat sides, open at both ends.

    x = at + s(u) + z n,   s once round the section from a corner, z from 0 to length

A dent pushes the sides along their normals, those across `side` inwards and the others outwards, by
depth sin(pi w) sin^2(pi (z - from) / (to - from)), w from 0 to 1 across a side: it decides where a
tube begins to fold. Consequence to test: the area is 2 (width + height) length.

A round tube is a whole `cylinder`.
"""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.meshes._mesh import Mesh, net


class Dent(Card):
    """Initial imperfection at which the sides begin to fold."""

    depth: float = quantity("m", "largest depth, in the middle of each side")
    from_: float = quantity("m", "height where it begins", ge=0)
    to: float = quantity("m", "height where it ends", gt=0)


class Tube(Card):
    """Rectangular tube; sets of nodes: v0 and v1 at its ends."""

    at: Vec3 = quantity("m", "middle of the first end", default=(0.0, 0.0, 0.0))
    axis: Vec3 = word("direction of the length", default=(0.0, 0.0, 1.0))
    side: Vec3 = word("direction of the width", default=(1.0, 0.0, 0.0))
    width: float = quantity("m", "between middle surfaces", gt=0)
    height: float | None = quantity("m", "across width and axis; width if absent", None, gt=0)
    length: float = quantity("m", "length along the axis", gt=0)
    elements: tuple[int, int, int] = word(
        "number of elements across the width, across the height and along", ge=1
    )
    dent: Dent | None = word("initial imperfection; none if absent", default=None)

    @property
    def count(self) -> int:
        """Number of elements."""
        return 2 * (self.elements[0] + self.elements[1]) * self.elements[2]


def build(card: Tube, scene: Scene) -> Mesh:
    axis, side = scene.unit(card.axis, "mesh.axis"), np.asarray(card.side, float)
    side = scene.unit(side - axis * float(axis @ side), "mesh.side")
    other, height = np.cross(axis, side), card.height or card.width
    nu, nw, nv = card.elements
    # once round, counter-clockwise about the axis
    corners = [
        sx * 0.5 * card.width * side + sy * 0.5 * height * other
        for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    round_, across, outward = [], [], []
    for k, n in enumerate((nu, nw, nu, nw)):
        w = np.arange(n)[:, None] / n
        start, end = corners[k], corners[(k + 1) % 4]
        round_.append(start + w * (end - start))
        across.append(w[:, 0])
        outward.append(np.tile((-other, side, other, -side)[k], (n, 1)))
    ring, w = np.concatenate(round_), np.concatenate(across)
    uv, quads, sets = net(len(ring), nv, closed=True)
    z = card.length * uv[:, 1:]
    points = np.asarray(card.at) + np.tile(ring, (nv + 1, 1)) + z * axis
    if card.dent is not None:
        d = card.dent
        if not d.from_ < d.to:
            raise scene.fail("ends before it begins", "mesh.dent.to")
        part = np.clip((z - d.from_) / (d.to - d.from_), 0.0, 1.0)
        sign = np.concatenate([np.full(n, s) for n, s in ((nu, 1), (nw, -1), (nu, 1), (nw, -1))])
        push = np.tile(d.depth * sign * np.sin(np.pi * w), nv + 1)[:, None]
        normal = np.tile(np.concatenate(outward), (nv + 1, 1))
        points += push * np.sin(np.pi * part) ** 2 * normal
    return Mesh(points, quads, sets)
