"""Folded plate: a line of straight pieces, moved along a vector; angles, Z and hat sections.

    x = line(u) + v along

Consequence to test: the area is the length of the line times that of the vector.
"""

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card, Vec3, quantity, word
from crashsolve.meshes._mesh import Mesh


class Folded(Card):
    """Line of straight pieces swept along a vector; sets: u0, u1 at its ends, v0, v1, fold_1 ..."""

    line: tuple[Vec3, ...] = quantity("m", "corners of the line; normals are line x along")
    along: Vec3 = quantity("m", "vector along which the line is swept")
    elements: tuple[int, ...] = word(
        "number of elements along each piece, then along the vector", ge=1
    )

    @property
    def count(self) -> int:
        """Number of elements."""
        return sum(self.elements[:-1]) * self.elements[-1] if self.elements else 0


def build(card: Folded, scene: Scene) -> Mesh:
    line, pieces = np.asarray(card.line, float).reshape(-1, 3), card.elements[:-1]
    if len(line) < 2 or len(card.elements) != len(line):
        message = (
            f"a line of {len(line)} corners has {len(line) - 1} pieces; give a number for each"
        )
        raise scene.fail(f"{message} and one for the vector", "mesh.elements")
    displacements = zip(line[:-1], line[1:], pieces, strict=True)
    row = np.concatenate(
        [a + np.arange(n)[:, None] / n * (b - a) for a, b, n in displacements] + [line[-1:]]
    )
    n, m = len(row), card.elements[-1]
    v = np.arange(m + 1)[:, None, None] / m
    points = (row + v * np.asarray(card.along)).reshape(-1, 3)
    number = np.arange(len(points)).reshape(m + 1, n)
    quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1)
    sets = {"u0": number[:, 0], "u1": number[:, -1], "v0": number[0], "v1": number[-1]}
    folds = np.cumsum(pieces)[:-1]
    sets |= {f"fold_{k + 1}": number[:, column] for k, column in enumerate(folds)}
    return Mesh(points, quads.reshape(-1, 4), sets)
