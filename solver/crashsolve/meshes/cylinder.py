"""Cylinder: quadrilaterals on a whole cylinder or on a sector of it.

    x = at + R (e cos phi + (n x e) sin phi) + z n,   phi from 0 to angle, z from 0 to length

Consequence to test: corners lie on the cylinder; the area tends to angle R length from below.
"""

from math import pi

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.foundation.orientation import perpendicular
from crashsolve.meshes._mesh import Mesh, net


class Cylinder(Card):
    """Sector: sets u0, u1 where it begins and ends; v0, v1 at both ends of its length."""

    at: Vec3 = quantity("m", "middle of the first end", default=(0.0, 0.0, 0.0))
    axis: Vec3 = word("direction of the length", default=(0.0, 0.0, 1.0))
    start: Vec3 | None = word("direction of phi = 0; any across the axis if absent", default=None)
    radius: float = quantity("m", "radius of the middle surface", gt=0)
    length: float = quantity("m", "length along the axis", gt=0)
    angle: float = quantity(
        "rad", "angle of the sector; a full cylinder if absent", default=2 * pi, gt=0
    )
    elements: tuple[int, int] = word("number of elements around and along", ge=1)

    @property
    def count(self) -> int:
        """Number of elements."""
        return self.elements[0] * self.elements[1]


def build(card: Cylinder, scene: Scene) -> Mesh:
    if card.angle > 2 * pi * (1.0 + 1e-12):
        raise scene.fail("must be at most a full circle, 360 deg", "mesh.angle")
    axis = scene.unit(card.axis, "mesh.axis")
    closed = card.angle > 2 * pi * (1.0 - 1e-12)
    if closed and card.elements[0] < 3:
        raise scene.fail("a full cylinder needs at least 3 elements around", "mesh.elements")
    start = perpendicular(axis) if card.start is None else np.asarray(card.start, float)
    start = scene.unit(start - axis * float(axis @ start), "mesh.start")
    uv, quads, sets = net(*card.elements, closed)
    phi, z = card.angle * uv[:, :1], card.length * uv[:, 1:]
    circle = np.cos(phi) * start + np.sin(phi) * np.cross(axis, start)
    return Mesh(np.asarray(card.at) + card.radius * circle + z * axis, quads, sets)
