"""A few shell elements whose kernels run as plain Python, moved by hand."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml

from crashsolve.deck.reading.deck import read_deck
from crashsolve.elements.shells.forces import blocks
from crashsolve.elements.shells.records import BLOCK, EROSION
from crashsolve.foundation.orientation import matrix
from crashsolve.foundation.rows import Rows, as_rows
from crashsolve.model.build import build

if TYPE_CHECKING:
    from crashsolve.foundation.rows import RowOfTable

STEEL = {"type": "elastic", "young": 2e5, "poisson": 0.3, "density": 8.0}
# the patch of MacNeal and Harder (1985): five elements of odd shapes on 0.24 by 0.12
PATCH = (
    [[0, 0], [0.24, 0], [0.24, 0.12], [0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08]]
    + [[0.08, 0.08]],
    [[1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8], [5, 6, 7, 8]],
)
KINDS = ("reduced", "fully_integrated", "triangles")
SQUARE = ([[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 2, 3, 4]])
ODD = ([[0, 0], [0.9, 0.1], [1.2, 0.8], [-0.2, 1.1]], [[1, 2, 3, 4]])


class Elements:
    """Elements on given nodes (n, 2 or 3), free of stress; motions are (n, 6)."""

    def __init__(
        self,
        folder: Path,
        mesh: Any = SQUARE,
        thickness: float = 0.05,
        material: dict[str, Any] = STEEL,
        curves: Mapping[str, Mapping[str, object]] | None = None,
        **words: object,
    ) -> None:
        nodes = np.asarray(mesh[0], float)
        nodes = np.hstack([nodes, np.zeros((len(nodes), 3 - nodes.shape[1]))])
        part = {"type": "shell", "thickness": thickness, "material": "steel"} | words
        part["mesh"] = {"type": "listed", "nodes": nodes.tolist(), "quads": mesh[1]}
        deck = {"control": {"end_time": 1}, "materials": {"steel": material}, "parts": {"s": part}}
        if curves:
            deck["curves"] = {name: {"type": "table", **card} for name, card in curves.items()}
        path = folder / "elements.yaml"
        path.write_text(yaml.safe_dump(deck), "utf-8")
        self.model, self.state = model, _ = build(read_deck(path))
        group = model.element_groups()[0]
        self.module, self.p = group.module, as_rows(group.parameters)[0]
        self.material = group.materials[0][1]
        used = [name for column, name in self.module.KINDS.items() if self.p[column]]
        self.kinds = [import_module(f"crashsolve.elements.shells.forces.{name}") for name in used]
        self.new = as_rows(group.history)[1, 0]
        self.out = as_rows(group.output)[0]
        self.clock: RowOfTable = as_rows(self.state.clock)[0]
        self.points: Rows = as_rows(self.state.points)
        e = model.elements
        assert e is not None
        self.element_cuts, self.cuts = e.element_cuts, e.cuts
        self.scene = SimpleNamespace(
            points=self.points,
            corners=e.corners,
            lanes=self.state.blocks,
            work=e.work,
            curves=as_rows(model.curves),
        )

    def move(self, motion: np.ndarray, h: float = 1.0) -> np.ndarray:
        """Forces and torques (n, 6) after a step of h with these velocities and spins."""
        self.points.v, self.points.w = motion[:, :3], motion[:, 3:]
        self.points.r += h * self.points.v
        self.points.force, self.points.torque = 0.0, 0.0
        self.clock.element_rate = 0.0
        self.points.rate, self.points.spin_rate = 0.0, 0.0
        for kind in self.kinds:
            blocks.deform(kind, self.p, self.clock, h, self.scene, self.material)
        return np.hstack([self.points.force, self.points.torque])

    def rotation(self, axis: np.ndarray, about: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Move all nodes by the rigid motion that a step of Cayley vector `axis` makes."""
        # x_new - x = axis x (x_new + x), both from the mean place of the centre of rotation
        S = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        R = np.linalg.solve(np.eye(3) - S, np.eye(3) + S)
        x = self.points.r - about
        motion = np.hstack([x @ R.T - x + direction, np.tile(2.0 * axis, (len(x), 1))])
        self.move(motion)
        return R

    def energies(self) -> RowOfTable:
        self.module.energies(self.p, self.new, self.out, self.scene)
        for kind in self.kinds:
            blocks.add_energies(kind, self.p, self.out, self.scene, self.material)
        return self.out

    def stiffness(self) -> np.ndarray:
        """Derivative of minus the forces by the motions (6 n, 6 n), from small steps."""
        start, rest = self.points.copy(), self.state.blocks.copy()
        columns, size = [], 1e-7
        for direction in np.eye(6 * len(start)):
            force = self.move(size * direction.reshape(-1, 6))
            columns.append(-force.ravel() / size)
            self.points[:], self.state.blocks[:] = start, rest
        return np.array(columns).T

    def rows(self, first: int, count: int) -> np.ndarray:
        """Numbers of all elements (elements, count)."""
        table = self.state.blocks.reshape(-1, int(self.p.stride) // 16, 16)
        rows = table[:, first : first + count].transpose(0, 2, 1).reshape(-1, count)
        return rows[: int(self.p.element_count)].copy()

    def layers(self, element: int = 0) -> np.ndarray:
        """Rows of all layers at all points of an element (points times layers, rows)."""
        count = int(self.p.stride) // 16 - BLOCK.SIZE - EROSION.SIZE * bool(self.p.erodes)
        return self.rows(BLOCK.SIZE, count)[element].reshape(-1, int(self.p.layer_rows))


def any_rotation(seed: int) -> np.ndarray:
    """A rotation matrix."""
    q = np.random.default_rng(seed).normal(size=4)
    return matrix(q / np.linalg.norm(q))
