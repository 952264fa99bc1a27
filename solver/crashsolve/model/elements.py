"""Parts whose elements are kept in blocks: their rows, and the tables of all of them together."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.foundation.point import ATTACHED_POINT, LANES, MOTION, POINT
from crashsolve.model.materials import fill, laws_of, refuse_different, with_constants
from crashsolve.model.model import Elements, Group, Model

if TYPE_CHECKING:
    from crashsolve.deck.reading.deck import Deck
    from crashsolve.deck.reading.items import Entry
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.model.scene import Scene


CACHE_LINE = 64  # bytes


def build_elements(entries: list[Entry], scene: Scene) -> Group:
    """All parts of one type, a row each."""
    module = import_module(entries[0].module_name)
    laws = laws_of(entries, scene)
    table = np.zeros(len(entries), with_constants(module.PARAMETERS, laws))
    for row, entry in zip(table, entries, strict=True):
        with scene.building(entry):
            scene.refuse_stepwise(module)
            values = module.parameters(scene.meshed(entry.name), scene)
            law, _ = scene.law("materials", entry.card.material)
            refuse_different(law, law.PARAMETERS, values["material"])
            fill(row, values)
            row["law"] = laws.index(law)
    names = [entry.name for entry in entries]
    history = np.zeros((2, len(entries)), module.HISTORY.dtype)
    output = np.zeros(len(entries), module.OUTPUT.dtype)
    word, numbered = entries[0].type, tuple(enumerate(laws))
    return Group("parts", word, module, names, table, history, output, materials=numbered)


def tables_of_elements(groups: list[Group], scene: Scene) -> Elements | None:
    """Corners, attached points of all parts; their positions go to the parts' rows. Writes:
    groups.
    """
    corners: list[np.ndarray] = []
    attached_points: list[np.ndarray] = []
    parts: dict[str, DiscretisedShell] = {}
    first = count = 0
    mass = 0.0
    for group in (g for g in groups if hasattr(g.module, "KINDS")):
        for name, row in zip(group.names, group.parameters, strict=True):
            meshed = parts[name] = scene.meshed(name)
            own = meshed.own
            row["first_point"], row["point_count"] = meshed.first + own.start, own.stop - own.start
            row["first"], row["stride"] = first, meshed.stride
            row["first_corner"], row["first_element"] = sum(len(own) for own in corners), count
            row["element_count"] = len(meshed.area)
            corners.append((meshed.corners() + meshed.first).astype(np.int32).ravel())
            tied = _attached(meshed, scene.part_nodes[name], scene.attached[name], scene)
            attached_points.append(tied)
            mass += meshed.mass[own].sum() - meshed.mass[tied["point"] - meshed.first].sum()
            first += meshed.size
            count += len(meshed.area)
    if not corners:
        return None
    rows = max(g.module.ROWS for g in groups if hasattr(g.module, "KINDS"))
    work = line_up(rows * LANES)
    element_cuts, cuts = _cuts(groups, parts)
    mass -= scene.tied_mass
    tables = (
        np.concatenate(corners),
        np.concatenate(attached_points),
        work,
        parts,
        mass,
        element_cuts,
        cuts,
    )
    return Elements(*tables, motion=np.zeros(1, MOTION.dtype), ties=scene.ties)


def _cuts(groups: list[Group], parts: dict[str, DiscretisedShell]) -> tuple[np.ndarray, np.ndarray]:
    """Elements of all sections, those of a block together, and the sections."""
    from crashsolve.elements.shells.section_cut import CUT, CUT_ELEMENT

    cut_elements: list[tuple[object, ...]] = []
    count = 0
    for group in (g for g in groups if hasattr(g.module, "KINDS")):
        for i, (name, row) in enumerate(zip(group.names, group.parameters, strict=True)):
            for front in parts[name].cuts:
                for e in np.flatnonzero(front.any(axis=1)):
                    kind, block, corner, lane = parts[name].address(int(e))
                    at = (int(row["first"]) + block, int(row["first_corner"]) + corner)
                    cut_elements.append((i, kind, *at, lane, count, front[e]))
                count += 1
    cut_elements.sort(key=lambda element_cut: (element_cut[2], element_cut[4]))
    return np.array(cut_elements, CUT_ELEMENT.dtype), np.zeros(count, CUT.dtype)


def line_up(count: int) -> np.ndarray:
    """Zeros (n,) that begin where a cache line does: no vector of lanes lies across two lines."""
    room = np.zeros(count + CACHE_LINE // 8)
    first = -room.ctypes.data % CACHE_LINE // 8
    return room[first : first + count]


def _attached(
    meshed: DiscretisedShell, named: list[int], attached: list[tuple[int, int]], scene: Scene
) -> np.ndarray:
    """Points of a part that are attached to bodies: those of its named nodes, and welded ones."""
    pairs = [*zip(meshed.named, named, strict=True), *attached]
    rows = np.zeros(len(pairs), ATTACHED_POINT.dtype)
    for row, (point, node) in zip(rows, pairs, strict=True):
        row["point"], row["node"] = point + meshed.first, node
        row["spot"] = scene.to_body(node, meshed.mesh.points[point])
    return rows


def initial_points(model: Model, scene: Scene) -> np.ndarray:
    """All points (n,) at the start."""
    parts = _meshed(model, scene)
    table = np.zeros(scene.point_count, POINT.dtype)
    for meshed in parts:
        # in place: a copy of 10^5 elements would be the peak of memory
        first = meshed.first + meshed.own.start
        meshed.write_points(table[first : meshed.first + meshed.own.stop])
    return table


def initial_blocks(model: Model, deck: Deck, scene: Scene) -> np.ndarray:
    """Numbers of all blocks of elements at the start."""
    parts = _meshed(model, scene)
    names = [name for g in model.element_groups() for name in g.names]
    sizes = [meshed.size for meshed in parts]
    numbers, first = line_up(sum(sizes)), 0
    for name, meshed, size in zip(names, parts, sizes, strict=True):
        with scene.building(deck.entries["parts"][name]):
            meshed.write_blocks(numbers[first : first + size], scene)
        first += size
    scene.raise_errors()
    return numbers


def _meshed(model: Model, scene: Scene) -> list[DiscretisedShell]:
    """Parts with points in place, in the order of their tables."""
    names = (name for g in model.element_groups() for name in g.names)
    return [scene.meshed(name) for name in names]
