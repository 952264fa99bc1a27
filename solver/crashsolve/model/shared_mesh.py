"""Meshes that parts share: the part of each element, the order and the properties of nodes.

Nodes are in the order of the parts: those of the first, then the others of the second, and so
on. A part moves the nodes of its own range, and its elements act on all that they name. A node has
mass, inertia, supports and momentum of all its parts. Consequence to test: mass and momentum of a
mesh are those of its parts' elements.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Scene
from crashsolve.deck.card import Card
from crashsolve.foundation.distinct import distinct
from crashsolve.foundation.point import ATTACHED

if TYPE_CHECKING:
    from crashsolve.deck.building import EntryOfScene, PartOfScene
    from crashsolve.meshes._mesh import Mesh
    from crashsolve.meshes.shared import Shared

# velocities of a node by two parts that differ by less than this share are the same
SAME = 1e-9
# names that a warning lists
LISTED = 3


def shared_meshes(scene: Scene) -> dict[str, Mesh]:
    """Shares of the meshes under `meshes`, by the name of the part."""
    meshes: dict[str, Mesh] = {}
    for name, entry in scene.deck.entries["meshes"].items():
        from crashsolve.meshes.shared import Shared

        parts = parts_of(name, scene)
        with scene.building(entry):
            if isinstance(entry.card, Shared):
                raise scene.fail("has no nodes of its own; use type shared in the parts", "type")
            if not parts:
                scene.warn(f"mesh '{name}' is named by no part and left out")
                continue
            whole = _whole(entry, scene)
            meshes |= _shares(name, whole, parts, scene)
    return meshes


def _whole(entry: EntryOfScene, scene: Scene) -> Mesh:
    """The whole mesh, whose elements hang together."""
    try:
        whole = import_module(entry.module_name).build(entry.card, scene)
    except ValueError as problem:
        # as fields are called where a mesh stands within the card of its part
        field = getattr(problem, "field", None) or ""
        raise scene.fail(str(problem), field.removeprefix("mesh.") or None) from None
    from crashsolve.model.checks.mesh_check import faults

    if wrong := faults(whole):
        raise scene.fail(wrong)
    return whole


def parts_of(mesh: str, scene: Scene) -> list[EntryOfScene]:
    """Parts with elements of a mesh, in the order of the deck."""
    parts = scene.deck.entries["parts"].values()
    return [part for part in parts if _name_of(part.card) == mesh]


def _name_of(card: Card) -> str:
    mesh = getattr(card, "mesh", None)
    if mesh is None:
        return ""
    from crashsolve.meshes.shared import Shared

    return mesh.mesh if isinstance(mesh, Shared) else ""


def _shares(name: str, whole: Mesh, parts: list[EntryOfScene], scene: Scene) -> dict[str, Mesh]:
    """The mesh as each of its parts has it."""
    owner = np.full(len(whole.quads), -1)
    for k, part in enumerate(parts):
        with scene.building(part):
            own = _elements(part.card.mesh, whole, scene)
            if (owner[own] >= 0).any():
                first = int(own[np.argmax(owner[own] >= 0)])
                location = _shown(_middles(whole)[first])
                message = f"element {first + 1} of mesh '{name}', at {location}, is in part"
                message = f"{message} '{parts[owner[first]].name}' already"
                raise scene.fail(f"{message}; an element belongs to one part", "mesh")
            owner[own] = k
    if scene.errors:
        return {}
    _report_unowned(name, owner, scene)
    return _numbered(whole, owner, parts)


def _elements(card: Shared, whole: Mesh, scene: Scene) -> np.ndarray:
    """Numbers (n,) of the elements that a card names."""
    if card.elements:
        if card.elements not in whole.element_sets:
            known = ", ".join(sorted(whole.element_sets)) or "none; give low and high of a box"
            message = f"mesh '{card.mesh}' has no element set '{card.elements}' (sets: {known})"
            raise scene.fail(message, "mesh.elements")
        own = whole.element_sets[card.elements]
    elif card.low is not None:
        middles = _middles(whole)
        own = np.flatnonzero(((middles > card.low) & (middles < card.high)).all(axis=1))
    else:
        own = np.arange(len(whole.quads))
    if not len(own):
        raise scene.fail(f"has no element of mesh '{card.mesh}'", "mesh")
    return distinct(own)


def _middles(whole: Mesh) -> np.ndarray:
    """Means of the corners of the elements (m, 3) [m]."""
    middles: np.ndarray = whole.points[whole.quads].mean(axis=1)
    return middles


def _report_unowned(name: str, owner: np.ndarray, scene: Scene) -> None:
    """Warn of elements that no part has: they are left out of the run."""
    missing = np.flatnonzero(owner < 0)
    if len(missing):
        some = ", ".join(str(e + 1) for e in missing[:LISTED])
        some += ", ..." * (len(missing) > LISTED)
        noun = "element is" if len(missing) == 1 else "elements are"
        scene.warn(f"mesh '{name}': {len(missing)} {noun} in no part and left out ({some})")


def _numbered(whole: Mesh, owner: np.ndarray, parts: list[EntryOfScene]) -> dict[str, Mesh]:
    """The mesh of each part, with the nodes in the order of the parts."""
    first = np.full(len(whole.points), len(parts))
    for k in reversed(range(len(parts))):
        first[whole.quads[owner == k]] = k
    order = np.argsort(first, kind="stable")[: int((first < len(parts)).sum())]
    number = np.full(len(whole.points), -1)
    number[order] = np.arange(len(order))
    ends = np.cumsum([0, *(int((first == k).sum()) for k in range(len(parts)))])
    numbered, origin = {}, whole.points[0].copy()
    for k, part in enumerate(parts):
        quads = number[whole.quads[owner == k]]
        own = np.zeros(len(order), bool)
        own[quads] = True
        sets = {name: number[some][number[some] >= 0] for name, some in whole.sets.items()}
        numbered[part.name] = replace(
            whole,
            points=whole.points[order],
            quads=quads,
            # of a set of nodes, those of this part
            sets={name: some[own[some]] for name, some in sets.items()},
            element_sets={},
            own=slice(int(ends[k]), int(ends[k + 1])),
            origin=origin,
        )
    return numbered


def join(scene: Scene) -> None:
    """Sum masses and inertias of all parts at the nodes of shared meshes.

    Writes: the parts in place.
    """
    for name in scene.deck.entries["meshes"]:
        entries = parts_of(name, scene)
        if entries and not scene.errors:
            _join(entries, [scene.meshed(entry.name) for entry in entries], scene)


def _join(entries: list[EntryOfScene], parts: list[PartOfScene], scene: Scene) -> None:
    n = len(parts[0].mesh.points)
    lumps = [part.lumps for part in parts if part.lumps is not None]
    corners, mass, inertia = (np.concatenate(numbers) for numbers in zip(*lumps, strict=True))
    mass, inertia = np.bincount(corners, mass, n), np.bincount(corners, inertia, n)
    is_damped = any(part.is_damped for part in parts)
    momentum = sum((part.momentum for part in parts), np.zeros_like(parts[0].momentum))
    fixed, by = np.zeros(n, np.uint8), np.full(n, -1)
    velocity, spin = np.zeros((n, 3)), np.zeros((n, 3))
    for k, (entry, part) in enumerate(zip(entries, parts, strict=True)):
        with scene.building(entry):
            if part.card.drag != parts[0].card.drag:
                message = f"nodes of '{entries[0].name}' have another drag"
                raise scene.fail(f"{message}; give all parts of a mesh the same", "drag")
            both = part.used[by[part.used] >= 0]
            _refuse_fixed(part, fixed, entries, by, both, scene)
            _refuse_apart(part, (velocity, spin), entries, by, both, scene)
        new = part.used
        fixed[new] |= part.fixed[new]
        velocity[new], spin[new], by[new] = part.velocity[new], part.spin[new], k
    for part in parts:
        part.mass, part.J, part.fixed, part.is_damped = mass, inertia, fixed, is_damped
        part.velocity, part.spin, part.momentum = velocity, spin, momentum


def _refuse_fixed(
    part: PartOfScene,
    fixed: np.ndarray,
    entries: list[EntryOfScene],
    by: np.ndarray,
    both: np.ndarray,
    scene: Scene,
) -> None:
    """A node that a body carries is held, welded or named in one part alone."""
    clash = (np.maximum(fixed[both], part.fixed[both]) >= ATTACHED) & (fixed[both] > 0)
    clash &= part.fixed[both] > 0
    if clash.any():
        node = both[np.argmax(clash)]
        message = f"its node at {_shown(part.mesh.points[node])} is supported, welded or named here"
        message = f"{message} and in '{entries[by[node]].name}'"
        field = "welded" if part.card.welded else "nodes" if part.card.nodes else "supports"
        raise scene.fail(f"{message}; state it in one of them", field)


def _refuse_apart(
    part: PartOfScene,
    motion: tuple[np.ndarray, np.ndarray],
    entries: list[EntryOfScene],
    by: np.ndarray,
    both: np.ndarray,
    scene: Scene,
) -> None:
    """A node begins with one velocity, whichever of its parts states it."""
    velocity, spin = motion
    apart = np.linalg.norm(part.velocity[both] - velocity[both], axis=1)
    apart += np.linalg.norm(part.spin[both] - spin[both], axis=1)
    size = 1.0 + np.linalg.norm(velocity[both], axis=1) + np.linalg.norm(spin[both], axis=1)
    if (apart > SAME * size).any():
        node = both[np.argmax(apart / size)]
        message = f"its node at {_shown(part.mesh.points[node])} begins with another velocity in"
        message = f"{message} '{entries[by[node]].name}'"
        raise scene.fail(f"{message}; give both parts the same", "velocity")


def _shown(x: np.ndarray) -> str:
    return "({}) m".format(", ".join(f"{value:.4g}" for value in x))


def number_points(parts: list[PartOfScene]) -> int:
    """First point of each part's mesh among all, and the number of points. Writes: parts."""
    first, begun = 0, {}
    for part in parts:
        mesh = part.mesh
        key = id(mesh) if mesh.own is None else id(mesh.origin)
        if key not in begun:
            begun[key] = first
            first += len(mesh.points)
        part.first = begun[key]
    return first
