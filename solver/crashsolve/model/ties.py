"""Tied nodes: their rows for the step, and their masses, which go to the faces."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Protocol

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.foundation.point import ATTACHED, TIE

if TYPE_CHECKING:
    from crashsolve.deck.building import PartOfScene

# velocities of a node and of its position that differ by less than this share are the same
SAME = 1e-9


def tie_nodes(scene: Scene) -> np.ndarray:
    """Rows of TIE of all ties. Writes: both parts in place."""
    table = [np.zeros(0, TIE.dtype)]
    entries = list(scene.deck.entries["ties"].values()) if not scene.errors else []
    for entry in entries:
        with scene.building(entry):
            rows = import_module(entry.module_name).build(entry.card, scene)
            own = np.zeros(len(rows), TIE.dtype)
            for record, row in zip(own, rows, strict=True):
                for name, value in row.items():
                    record[name] = value
            _check_motion(own, entry.card, scene)
            _transfer_mass(own, entry.card, scene)
            table.append(own)
    ties = np.concatenate(table)
    tied = set(ties["point"].tolist())
    for entry, own in zip(entries, table[1:], strict=False):
        with scene.building(entry):
            _refuse_chain(own, tied, entry.card, scene)
    return ties


class Tie(Protocol):
    """Fields of a tie's card: the part of the nodes, and that of the faces."""

    @property
    def part(self) -> str: ...
    @property
    def to(self) -> str: ...


def _sides(card: Tie, scene: Scene) -> tuple[PartOfScene, PartOfScene]:
    tied, _, _ = scene.skin(card.part, "part")
    faces, _, _ = scene.skin(card.to, "to")
    return tied, faces


def _check_motion(rows: np.ndarray, card: Tie, scene: Scene) -> None:
    """Nodes begin with the motion of their positions on the faces."""
    from crashsolve.ties._faces import normal_rate

    tied, faces = _sides(card, scene)
    for row in rows:
        corners, node = row["corner"] - faces.first, int(row["point"]) - tied.first
        N, v = row["weight"], faces.velocity[corners]
        velocity = N @ v + row["height"] * normal_rate(faces.mesh.points[corners], v)
        apart = float(np.linalg.norm(tied.velocity[node] - velocity))
        spin = float(np.linalg.norm(tied.spin[node] - N @ faces.spin[corners]))
        fast = 1.0 + float(np.linalg.norm(velocity)) + float(np.linalg.norm(tied.spin[node]))
        if apart > SAME * fast or spin > SAME * fast:
            message = f"nodes begin {apart:.3g} m/s and {spin:.3g} rad/s faster than their faces"
            raise scene.fail(f"{message}; give both parts the same motion", "nodes")


def _transfer_mass(rows: np.ndarray, card: Tie, scene: Scene) -> None:
    """Mass, inertia and momenta of impulses go to the corners. Writes: both parts in place."""
    tied, faces = _sides(card, scene)
    for row in rows:
        corners, node = row["corner"] - faces.first, int(row["point"]) - tied.first
        for corner, N in zip(corners, row["weight"], strict=True):
            faces.mass[corner] += N * tied.mass[node]
            faces.J[corner] += N * tied.J[node]
        if np.any(tied.momentum):
            share = row["weight"][:, None] * tied.momentum[node]
            whole = np.array(np.broadcast_to(faces.momentum, faces.mesh.points.shape))
            np.add.at(whole, corners, share)
            for part in scene.on_mesh_of(faces):
                part.momentum = whole
        tied.fixed[node] = ATTACHED
        scene.tied_mass += float(tied.mass[node])


def _refuse_chain(rows: np.ndarray, tied: set[int], card: Tie, scene: Scene) -> None:
    """A face with tied nodes has no corner that is tied itself."""
    if tied.intersection(rows["corner"].ravel().tolist()):
        message = f"a face of '{card.to}' to which nodes are tied has a corner that is tied itself"
        raise scene.fail(f"{message}; tie the nodes of the same side in all ties", "to")
