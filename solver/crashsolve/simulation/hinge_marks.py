"""Hinges in pictures: a ball in the point of each, with its permanent rotation or displacement.

    plastic_angle = |(alpha_1, alpha_2)|,   plastic_stroke = alpha of the travel along the beam

alpha is the sum of plastic displacements in both directions, as in the channels of the hinge.
"""

import numpy as np

from crashsolve.deck.family import MARK, families
from crashsolve.model.model import Group, Model
from crashsolve.output import shapes
from crashsolve.output.blocks import Block, FieldSpec

NAME = "hinges"
BODY = FieldSpec("body", "1", 1, "cell")
FIELDS = {
    "plastic_angle": FieldSpec("plastic_angle", "rad", 1, "cell"),
    "plastic_stroke": FieldSpec("plastic_stroke", "m", 1, "cell"),
}
# radius of a ball, of the model's size: more than half of a post that is 20 times as long
RADIUS = 0.04


class HingeMarks:
    """The balls of all hinges of a model that has some."""

    def __init__(self, model: Model, nodes: np.ndarray) -> None:
        self.groups = [g for g in model.groups if families()[g.keyword].picture == MARK]
        self.ball, self.triangles = shapes.sphere(RADIUS * model.size)
        self.start = self._positions(nodes)
        # of the motions of the hinges of this model
        self.specs = {
            name: spec
            for name, spec in FIELDS.items()
            if any(name in (g.output.dtype.names or ()) for g in self.groups)
        }

    def blocks(self) -> tuple[Block, ...]:
        """The block of all balls."""
        count, n = len(self.start), len(self.ball)
        points = (self.start[:, None] + self.ball).reshape(-1, 3)
        cells = (self.triangles + n * np.arange(count)[:, None, None]).reshape(-1, 3)
        bodies = np.concatenate([np.maximum(*_ends(g)) for g in self.groups])
        owners = np.repeat(bodies.astype(float), len(self.triangles))
        specs = tuple(self.specs.values())
        return (Block(NAME, points, (("triangle", cells),), specs, ((BODY, owners),)),)

    def fields(self, nodes: np.ndarray) -> dict[str, dict[str, np.ndarray]]:
        """Displacements (points, 3) [m] of the balls, and how far their hinges have yielded [1]."""
        moved = np.repeat(self._positions(nodes) - self.start, len(self.ball), axis=0)
        fields_of_marks = {"displacement": moved}
        for name in self.specs:
            values = np.concatenate([_yielded(g, name) for g in self.groups])
            fields_of_marks[name] = np.repeat(values, len(self.triangles))
        return {NAME: fields_of_marks}

    def _positions(self, nodes: np.ndarray) -> np.ndarray:
        """Joint points (n, 3), in the bodies that carry the axes."""
        positions = []
        for g in self.groups:
            body = nodes[g.parameters["node_a"]]
            A = body["A"].reshape(-1, 3, 3)
            positions.append(body["r"] + np.einsum("nij,nj->ni", A, g.parameters["point_a"]))
        return np.concatenate(positions)


def _ends(group: Group) -> tuple[np.ndarray, np.ndarray]:
    return group.parameters["node_a"], group.parameters["node_b"]


def _yielded(group: Group, name: str) -> np.ndarray:
    """An output of each hinge, its size where it has two components; 0 where there is none."""
    if name not in (group.output.dtype.names or ()):
        return np.zeros(len(group.names))
    values = group.output[name]
    norms: np.ndarray = np.linalg.norm(values, axis=1) if values.ndim == 2 else values
    return norms
