"""Tyres of wheels that stand: while an equilibrium is searched, their carcass is a spring.

    q <- q - (x . s, y . s),   s the displacement of the wheel's point on the road, against the road

A tyre slips by velocities, and without motion it has no force; a wheel that does not roll is held
by the deflection q of its carcass all the same, up to friction. So q follows the displacements of
the search for every tyre whose wheel and road begin at rest. A wheel that is free to roll turns
until nothing holds it along the road. Consequence to test: a braked car on a slope begins at rest,
with the deflections sigma F / C of these forces.
"""

from typing import NamedTuple

import numpy as np

from crashsolve.foundation.orientation import quaternion_of
from crashsolve.foundation.rows import as_rows
from crashsolve.model.model import Group, Model


class Footprint(NamedTuple):
    """A standing tyre on one of its roads, in the configuration that was accepted last."""

    group: Group
    row: int
    road: int
    x: np.ndarray  # along the wheel, world axes
    y: np.ndarray  # across it
    foot: np.ndarray  # point on the road, world axes [m]
    q: tuple[float, float]  # deflections [m]


class StandingTyres:
    """All tyres that stand, with their deflections in the histories of their groups."""

    def __init__(self, model: Model, nodes: np.ndarray, current: int) -> None:
        """`nodes` with the velocities of the deck; `current` of the two histories is accepted."""
        self.model, self.current = model, current
        moves = np.concatenate([nodes["v"], nodes["w"]], axis=1).any(axis=1)
        still = np.logical_not(moves)
        self.patches = [
            (group, row, road)
            for group in model.groups
            if hasattr(group.module, "patch_of")
            for row, p in enumerate(group.parameters)
            for road in range(int(p["roads"]))
            if still[p["node"]] and still[p["road_node"][road]]
        ]
        self.nodes = nodes.copy()
        self.footprints: list[Footprint] = []

    def release(self, nodes: np.ndarray) -> None:
        """Set the deflections of all carcasses to zero in this configuration. Writes: histories."""
        for group, row, road in self.patches:
            for name in ("q_x", "q_y", "store"):
                group.history[name][:, row, road] = 0.0
        self.accept(nodes)

    def accept(self, nodes: np.ndarray) -> None:
        """Count deflections from this configuration, which has just been sampled at rest."""
        if not self.patches:
            return
        self.nodes = nodes.copy()
        table, curves = as_rows(self.nodes), as_rows(self.model.curves)
        self.footprints = [self._footprint(*patch, table, curves) for patch in self.patches]

    def _footprint(
        self, group: Group, row: int, road: int, nodes: np.ndarray, curves: np.ndarray
    ) -> Footprint:
        data = tuple(as_rows(part) for part in group.data) or None
        at = group.module.patch_of(as_rows(group.parameters)[row], road, nodes, curves, data)
        # deflections of the sample: within friction, and zero off the road
        footprint = group.history[1 - self.current]
        q = float(footprint["q_x"][row, road]), float(footprint["q_y"][row, road])
        hub = self.nodes["r"][group.parameters["node"][row]]
        return Footprint(group, row, road, np.array(at.x), np.array(at.y), hub + at.foot, q)

    def follow(self, nodes: np.ndarray) -> None:
        """Deflections of another configuration, near the one accepted. Writes: histories."""
        for group, row, road, x, y, foot, q in self.footprints:
            p = group.parameters[row]
            s = self._moved(p["node"], foot, nodes) - self._moved(p["road_node"][road], foot, nodes)
            now = group.history[self.current]
            now["q_x"][row, road], now["q_y"][row, road] = q[0] - x @ s, q[1] - y @ s

    def _moved(self, node: int, point: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """Displacement of a point of a body since it was accepted, to first order (3,) [m].

        A wheel that rolls by any angle thus does not move it: its centre moves by r theta.
        """
        before, now = self.nodes[node], nodes[node]
        q = quaternion_of(now["A"].reshape(3, 3) @ before["A"].reshape(3, 3).T)
        sine = float(np.linalg.norm(q[1:]))
        angle = 2.0 * np.arctan2(sine, abs(q[0]))
        rotation = np.copysign(1.0, q[0]) * q[1:] * (angle / sine if sine > 0.0 else 2.0)
        return np.asarray(now["r"] - before["r"] + np.cross(rotation, point - before["r"]))

    def commit(self) -> None:
        """Begin the run with the deflections of the last sample. Writes: histories."""
        for group, row, road in self.patches:
            for name in ("q_x", "q_y", "store"):
                now = group.history[name]
                now[self.current, row, road] = now[1 - self.current, row, road]

    def sliding(self) -> str:
        """Names of tyres that slide all over, of the last sample."""
        names = [
            group.names[row]
            for group, row, _ in self.patches
            if group.output["sliding"][row] >= 1.0
        ]
        return ", ".join(dict.fromkeys(names))
