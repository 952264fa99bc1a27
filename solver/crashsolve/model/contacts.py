"""Build of contact: surfaces to elements, pairs of surfaces to pairs of elements.

The gap routine of shapes `sphere` and `plane` is contact/narrow/sphere_plane.py, whichever stands
on side a of the card. A shape may say GAP_AS to use the routines of another shape.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from crashsolve.foundation.record import Record
from crashsolve.model.model import ContactGroup
from crashsolve.model.scene import Scene
from crashsolve.system import contacts as system

if TYPE_CHECKING:
    from crashsolve.deck.read import Deck, Entry

NARROW = "crashsolve.contact.narrow"


class Surface:
    """Elements of one surface card."""

    def __init__(self, entry: Entry, scene: Scene) -> None:
        self.entry = entry
        self.module = import_module(entry.module_name)
        self.elements: list[dict[str, Any]] = self.module.build(entry.card, scene)
        self.shape = getattr(self.module, "GAP_AS", entry.type)
        self.radius = self.module.curvature_radius(entry.card)


class Pair:
    """What a normal law may ask about the two surfaces it acts between."""

    def __init__(self, a: Surface, b: Surface) -> None:
        self.radius_a, self.radius_b = a.radius, b.radius


def build_contacts(deck: Deck, scene: Scene) -> list[ContactGroup]:
    """Contact groups of all contact cards."""
    surfaces: dict[str, Surface] = {}
    for name, entry in deck.entries["surfaces"].items():
        with scene.building(entry):
            surfaces[name] = Surface(entry, scene)
    scene.surfaces = surfaces
    builders: dict[str, GroupBuilder] = {}
    for index, entry in enumerate(deck.entries["contacts"].values()):
        with scene.building(entry):
            _add_card(index, entry, surfaces, builders, scene)
    return [builder.finish() for builder in builders.values()]


def _add_card(
    index: int,
    entry: Entry,
    surfaces: dict[str, Surface],
    builders: dict[str, "GroupBuilder"],
    scene: Scene,
) -> None:
    card = entry.card
    for name_a in card.a:
        for name_b in card.b:
            if name_a not in surfaces or name_b not in surfaces:
                continue  # its own card is wrong and already reported
            a, b = surfaces[name_a], surfaces[name_b]
            narrow, swapped = gap_routine(a, b, scene)
            key = "_".join([narrow.__name__.rpartition(".")[2], _law(card.normal)])
            key += f"_{_law(card.friction)}" if card.friction is not None else ""
            key += "_swapped" if swapped else ""
            if key not in builders:
                builders[key] = GroupBuilder(key, narrow, swapped, card)
            builders[key].add(index, card, a, b, scene)


def _law(card: Any) -> str:
    return str(type(card).__module__.rpartition(".")[2])


def gap_routine(a: Surface, b: Surface, scene: Scene) -> tuple[Any, bool]:
    """Module of the gap between two shapes, and whether it takes them the other way round."""
    for first, second, swapped in ((a, b, False), (b, a, True)):
        name = f"{NARROW}.{first.shape}_{second.shape}"
        if find_spec(name) is not None:
            return import_module(name), swapped
    raise scene.fail(
        f"no gap between a {a.entry.type} ('{a.entry.name}') and a {b.entry.type} "
        f"('{b.entry.name}'); give one of them another shape",
        "b",
    )


class GroupBuilder:
    """Collects the pairs that share gap routine and laws."""

    def __init__(self, word: str, narrow: Any, swapped: bool, card: Any) -> None:
        self.word, self.narrow, self.swapped = word, narrow, swapped
        self.normal = import_module(type(card.normal).__module__)
        self.friction = (
            None if card.friction is None else import_module(type(card.friction).__module__)
        )
        self.elements: tuple[list[Any], list[Any]] = ([], [])
        self.shapes: list[Any] = [None, None]
        self.first: tuple[dict[str, int], dict[str, int]] = ({}, {})
        self.rows: list[dict[str, Any]] = []

    def add(self, index: int, card: Any, a: Surface, b: Surface, scene: Scene) -> None:
        """All element pairs of two surfaces under one card."""
        law = self.normal.build(card.normal, scene, Pair(a, b))
        if self.friction is not None:
            law |= self.friction.build(card.friction, scene)
        sides = (b, a) if self.swapped else (a, b)
        starts = [self._place(side, surface) for side, surface in enumerate(sides)]
        same = a is b
        for i in range(len(sides[0].elements)):
            for j in range(i + 1 if same else 0, len(sides[1].elements)):
                if sides[0].elements[i]["node"] == sides[1].elements[j]["node"]:
                    continue
                base = {
                    "a": starts[0] + i,
                    "b": starts[1] + j,
                    "card": index,
                    "speed_floor": card.speed_floor,
                }
                self.rows.append(base | law)

    def _place(self, side: int, surface: Surface) -> int:
        """Index of a surface's first element in the table of its side."""
        known = self.first[side]
        if surface.entry.name not in known:
            known[surface.entry.name] = len(self.elements[side])
            self.elements[side].extend(surface.elements)
            self.shapes[side] = surface.module
        return known[surface.entry.name]

    def finish(self) -> ContactGroup:
        laws = [self.normal] + ([self.friction] if self.friction else [])
        parameters, history, output = system.PARAMETERS, system.HISTORY, system.OUTPUT
        for law in laws:
            parameters, history = parameters + law.PARAMETERS, history + law.HISTORY
        n = len(self.rows)
        rest = np.zeros((2, n), history.dtype)
        rest["depth"] = -1e300
        data = getattr(self.narrow, "data", lambda *_: (np.zeros(0),))
        return ContactGroup(
            word=self.word,
            narrow=self.narrow,
            normal=self.normal,
            friction=self.friction,
            elements_a=_table(self.elements[0], self.shapes[0].PARAMETERS),
            elements_b=_table(self.elements[1], self.shapes[1].PARAMETERS),
            data=data(self.elements[0], self.elements[1]),
            parameters=_table(self.rows, parameters),
            history=rest,
            output=np.zeros(n, output.dtype),
        )


def _table(rows: list[dict[str, Any]], record: Record) -> np.ndarray:
    table = np.zeros(len(rows), record.dtype)
    for i, values in enumerate(rows):
        for column in record.columns:
            table[i][column.name] = values[column.name]
    return table
