"""Sphere, or an eighth or half of it: three squares in each eighth, so that no node is a pole.

Consequence to test: all nodes lie on the sphere, and the sides of an eighth on planes of symmetry.
"""

from typing import Literal

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.meshes._mesh import Mesh, net, welded

# eighths by the signs of x, y, z
EIGHTHS = {"eighth": ((1,), (1,), (1,)), "half": ((1, -1), (1, -1), (1,)), "whole": ((1, -1),) * 3}


class Sphere(Card):
    """Sphere, its half z > 0, or its eighth x, y, z > 0; sets: its open sides x0, y0, z0."""

    centre: Vec3 = quantity("m", "centre of the sphere", default=(0.0, 0.0, 0.0))
    radius: float = quantity("m", "R", gt=0)
    part: Literal["eighth", "half", "whole"] = word("part of the sphere", default="whole")
    elements: int = word("number of elements along an eighth of a great circle", ge=1)

    @property
    def count(self) -> int:
        """Number of elements."""
        return 3 * {"eighth": 1, "half": 4, "whole": 8}[self.part] * self.elements**2


def build(card: Sphere, scene: Scene) -> Mesh:
    points, quads = _eighth(card.elements)
    positions: list[np.ndarray] = []
    corners: list[np.ndarray] = []
    signs = EIGHTHS[card.part]
    for octant in (np.array([x, y, z]) for x in signs[0] for y in signs[1] for z in signs[2]):
        # a mirror turns the corners round
        corners.append(
            (quads if octant.prod() > 0 else quads[:, ::-1]) + sum(len(own) for own in positions)
        )
        positions.append(points * octant)
    unit, four, _ = welded(np.concatenate(positions), np.concatenate(corners))
    sides = {"eighth": "xyz", "half": "z", "whole": ""}[card.part]
    sets = {f"{axis}0": np.flatnonzero(unit[:, "xyz".index(axis)] == 0.0) for axis in sides}
    return Mesh(np.asarray(card.centre) + card.radius * unit, four, sets)


def _eighth(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, 3) and quadrilaterals of three squares of n by n around the axes."""
    uv, quads, _ = net(n, n)
    # steps of equal angle along all edges
    u, v = np.tan(0.25 * np.pi * uv.T[:, :, None])
    points, corners = [], []
    for k in range(3):
        x = np.eye(3)[k] + u * np.eye(3)[(k + 1) % 3] + v * np.eye(3)[(k + 2) % 3]
        points.append(x / np.linalg.norm(x, axis=1)[:, None])
        corners.append(quads + k * len(x))
    return np.concatenate(points), np.concatenate(corners)
