"""Build of contact: surfaces to elements, pairs of surfaces to pairs of elements.

The gap routine of shapes `sphere` and `plane` is contact/narrow/sphere_plane.py, whichever stands
on side a of the card. A shape may say GAP_AS to use the routines of another shape. A gap routine
may say expand_a, expand_b to take the elements of a surface apart (a box into its corners), with
PARAMETERS_A, PARAMETERS_B for its own columns of them, and `data` for arrays that all elements
share. One whose gap between bodies apart is their distance, and costs more than a few products,
sets IS_DISTANCE: such pairs are skipped until they may have met (system/contact/resting.py),
those of the same two bodies together (model/contact/body_pairs.py). Pairs of shapes whose gap is
the same kernel, under the same laws, form one group.
"""

from __future__ import annotations

from collections import defaultdict
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from math import inf
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.card import Card
from crashsolve.deck.family import check_law
from crashsolve.deck.roles import NormalLaw, StepFriction, StepGap
from crashsolve.foundation.record import Record
from crashsolve.model.attachments import IMPLICIT
from crashsolve.model.contact import records
from crashsolve.model.contact.doubles import TwoSided, warn_of_common_pairs
from crashsolve.model.contact.floor import speed_floor
from crashsolve.model.contact.groups import ContactGroup, NodalGroup
from crashsolve.model.contact.holes import warn_of_holes
from crashsolve.model.contact.pairs import (
    INFINITE_EXTENT,
    Block,
    Elements,
    Pairing,
    Search,
    resting,
)
from crashsolve.model.materials import refuse_different
from crashsolve.model.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from crashsolve.deck.reading.deck import Deck
    from crashsolve.deck.reading.items import Entry
    from crashsolve.model.contact.node_to_surface import NodalBuilder
    from crashsolve.model.contact.sides import Shaped

NARROW = "crashsolve.contact.narrow"
SHAPE = "crashsolve.contact.shape"
# shapes of surfaces of meshes, which are no elements on bodies
MESHED = {"points", "faces"}
# shapes whose edges are rounded by a share of the smaller side of a touch
EDGED = {"box", "cylinder"}


class Surface:
    """Elements of one surface card."""

    def __init__(self, entry: Entry, rank: int, scene: Scene) -> None:
        self.entry, self.rank = entry, rank
        self.module = import_module(entry.module_name)
        self.elements: list[Columns] = self.module.build(entry.card, scene)
        self.shape = getattr(self.module, "GAP_AS", entry.type)
        if hasattr(self.module, "gap_as"):
            self.shape = self.module.gap_as(entry.card, scene)
        self.radius = self.module.curvature_radius(entry.card)
        # the smallest boxes and cylinders that it may touch, one for each side of a card
        self.others: list[Columns] = []
        # the ellipsoids that it may touch
        self.ellipsoids: list[Columns] = []


class Pair:
    """The contact and its two surfaces, for the build of a normal law."""

    def __init__(self, contact: str, radius_a: float | None, radius_b: float | None) -> None:
        self.contact, self.radius_a, self.radius_b = contact, radius_a, radius_b


def build_contacts(deck: Deck, scene: Scene) -> tuple[list[ContactGroup], list[NodalGroup]]:
    """Contact groups of all contact cards: of pairs, and of shell nodes and faces."""
    surfaces: dict[str, Surface] = {}
    for rank, (name, entry) in enumerate(deck.entries["surfaces"].items()):
        with scene.building(entry):
            surfaces[name] = Surface(entry, rank, scene)
    scene.surfaces = surfaces
    for entry in deck.entries["contacts"].values():
        measure_opposite_sides(entry.card, surfaces)
    builders: dict[str, GroupBuilder] = {}
    nodal = _nodal_builder(surfaces, scene)
    for index, entry in enumerate(deck.entries["contacts"].values()):
        with scene.building(entry):
            _add_card(index, entry, surfaces, builders, nodal, scene)
    if scene.errors:
        return [], []
    for name, entry in deck.entries["contacts"].items():
        sides = [[surfaces[word] for word in names] for names in (entry.card.a, entry.card.b)]
        warn_of_holes(name, sides, scene)
    warn_of_common_pairs(deck.entries["contacts"], deck.entries["surfaces"], scene)
    nodes = scene.placed_nodes()
    is_implicit = deck.control.integrator in IMPLICIT
    groups = [builder.finish(nodes, is_implicit) for builder in builders.values()]
    return groups, nodal.groups if nodal else []


def _nodal_builder(surfaces: dict[str, Surface], scene: Scene) -> NodalBuilder | None:
    """The builder of contacts of meshes; None of a scene without such surfaces."""
    if not any(surface.shape in MESHED for surface in surfaces.values()):
        return None
    from crashsolve.model.contact.node_to_surface import NodalBuilder

    return NodalBuilder(scene)


def _add_card(
    index: int,
    entry: Entry,
    surfaces: dict[str, Surface],
    builders: dict[str, GroupBuilder],
    nodal: NodalBuilder | None,
    scene: Scene,
) -> None:
    card, laws = entry.card, _laws(entry.card)
    sides = [_by_shape(names, surfaces) for names in (card.a, card.b)]
    on_both = set(card.a) & set(card.b)
    bodies = [
        {e["node"] for group in side.values() for s in group for e in s.elements} for side in sides
    ]
    is_meshed = any(MESHED & set(side) for side in sides)
    is_whole = all(name in surfaces for name in (*card.a, *card.b))
    if is_whole and not is_meshed and len(bodies[0] | bodies[1]) == 1:
        if bodies[0] == {0}:
            raise scene.fail("all its surfaces are on the ground; give one of them a body", "b")
        raise scene.fail("all its surfaces are on one body; a body cannot touch itself", "b")
    law = import_module(type(laws[0]).__module__)
    if hasattr(law, "check"):
        law.check(laws[0], scene, *bodies)
    for some_a in sides[0].values():
        for some_b in sides[1].values():
            if nodal is not None and {some_a[0].shape, some_b[0].shape} & MESHED:
                _refuse_torsion(card, scene)
                for a, b in product(some_a, some_b):
                    nodal.add(index, entry, a, b, gap_routine)
                continue
            narrow, swapped = gap_routine(some_a[0], some_b[0], scene)
            builder = _builder_of(_gap_module(narrow), card, laws, builders)
            builder.add(index, entry, narrow, swapped, (some_a, some_b), on_both, scene)


def _refuse_torsion(card: Card, scene: Scene) -> None:
    """Raises the error of a card whose torsion_radius has no effect."""
    if _torsion_radius(card) is not None:
        raise scene.fail(
            "is for rigid shapes; leave it out: friction at many points of a shell resists a spin "
            "without it",
            "torsion_radius",
        )


def _builder_of(
    gap_module: ModuleType, card: Card, laws: list[Card], builders: dict[str, GroupBuilder]
) -> GroupBuilder:
    """The builder of the group with this gap routine and these laws. Writes: builders."""
    key = "_".join([_leaf(gap_module.__name__), *(_leaf(type(law).__module__) for law in laws)])
    if _torsion_radius(card) is not None:
        key += "_torsion"
    if key not in builders:
        builders[key] = GroupBuilder(key, gap_module, laws)
    return builders[key]


def _torsion_radius(card: Card) -> float | None:
    """Radius [m] with which friction of a contact card resists a spin, if it gives one."""
    return getattr(card, "torsion_radius", None)


def _laws(card: Any) -> list[Card]:
    """Laws of a contact card: those it names, or itself."""
    if not hasattr(card, "normal"):
        return [card]
    return [card.normal] + ([] if card.friction is None else [card.friction])


def _by_shape(names: Iterable[str], surfaces: dict[str, Surface]) -> dict[str, list[Surface]]:
    """Surfaces of one side of a card by shape; one that is missing has been reported already."""
    surfaces_of: dict[str, list[Surface]] = defaultdict(list)
    for name in dict.fromkeys(names):
        if name in surfaces:
            surfaces_of[surfaces[name].shape].append(surfaces[name])
    return surfaces_of


def _leaf(module_name: str) -> str:
    return module_name.rpartition(".")[2].strip("_")


def _gap_module(narrow: ModuleType) -> ModuleType:
    """Module in which the gap kernel is written: pairs of shapes that share it form one group."""
    return import_module(narrow.gap.__module__)


def gap_routine(a: Shaped, b: Shaped, scene: Scene) -> tuple[ModuleType, bool]:
    """Module of the gap between two shapes, and whether it takes them in reverse order."""
    for first, second, swapped in ((a, b, False), (b, a, True)):
        name = f"{NARROW}.{first.shape}_{second.shape}"
        if find_spec(name) is not None:
            module = import_module(name)
            check_law(module)
            return module, swapped
    raise scene.fail(
        f"there is no contact between a {a.entry.type} ('{a.entry.name}') and a {b.entry.type} "
        f"('{b.entry.name}'); give one of them another shape",
        "b",
    )


def measure_opposite_sides(card: TwoSided, surfaces: dict[str, Surface]) -> None:
    """Report the surfaces of each side of a card the thinnest box or cylinder of the other, the
    narrowest, and the ellipsoids.

    Writes: their `others` and `ellipsoids`.
    """
    sides = [[surfaces[name] for name in names if name in surfaces] for names in (card.a, card.b)]
    for side, facing in (sides, sides[::-1]):
        elements = [e for s in facing if s.shape in EDGED for e in s.elements]
        if elements:
            edged = import_module(f"{NARROW}._edged")
            smallest = [min(elements, key=k) for k in (edged.least_half, edged.widest_half)]
            for surface in side:
                surface.others.extend(smallest)
        ellipsoids = [e for s in facing if s.shape == "ellipsoid" for e in s.elements]
        for surface in side:
            surface.ellipsoids.extend(ellipsoids)


class Side:
    """Elements on one side of a gap routine, surface after surface."""

    def __init__(self, letter: str) -> None:
        self.letter = letter
        self.record: Record | None = None
        self.elements: list[Columns] = []
        self.surfaces: dict[str, range] = {}
        self._of: list[Surface] = []
        self._bounds: list[tuple[ArrayLike, float, float]] = []
        self._reaches: list[float] = []
        self._rounds: dict[str, int] = {}

    def assign(self, surface: Surface, narrow: ModuleType) -> None:
        """Append a surface's elements, taken apart as the gap asks, when it is first seen."""
        name = surface.entry.name
        if name in self.surfaces:
            return
        expand = getattr(narrow, f"expand_{self.letter}", lambda elements, *others: elements)
        first = len(self.elements)
        kind = import_module(narrow.gap.__module__)
        facing = [surface.others] if hasattr(kind, "least_half") else []
        facing += [surface.ellipsoids] if hasattr(kind, "expand_sharp") else []
        for element in surface.elements:
            parts = expand([element], *facing)
            self.elements.extend(parts)
            centre, radius, thick = _bound(surface, element)
            # a part is followed by its own point, and reaches no farther from it than the whole
            is_whole = len(parts) == 1 and parts[0] is element
            for part in parts:
                at = centre if is_whole else part["point"]
                self._bounds.append((at, radius, thick))
                # a part that is a ball gives its size
                own = radius if is_whole else part.get("radius", radius)
                reach = float(np.linalg.norm(at)) + own
                self._reaches.append(reach if np.isfinite(reach) else INFINITE_EXTENT)
        self.surfaces[name] = range(first, len(self.elements))
        self._of.extend([surface] * len(self.surfaces[name]))
        self._rounds.setdefault(str(surface.radius), len(self._rounds))
        own = import_module(f"{SHAPE}.{surface.shape}").PARAMETERS
        self.record = getattr(narrow, f"PARAMETERS_{self.letter.upper()}", own)

    def round_of(self, surface: Surface) -> int:
        """Class of its radius of curvature."""
        return self._rounds[str(surface.radius)]

    def mask(self, names: Iterable[str]) -> np.ndarray:
        """Mask of the elements of the named surfaces."""
        mask = np.zeros(len(self.elements), bool)
        for name in names:
            if name in self.surfaces:
                mask[self.surfaces[name]] = True
        return mask

    def arrays(self) -> Elements:
        """The elements as pairing sees them."""
        return Elements(
            node=np.array([e["node"] for e in self.elements]),
            rank=np.array([s.rank for s in self._of]),
            round=np.array([self.round_of(s) for s in self._of]),
            centre=np.array([centre for centre, _, _ in self._bounds]),
            radius=np.array([radius for _, radius, _ in self._bounds]),
            thick=np.array([thick for _, _, thick in self._bounds]),
            normal=np.array([e.get("normal", (0.0, 0.0, 0.0)) for e in self.elements]),
            reach=np.array(self._reaches),
        )


def _bound(surface: Surface, element: Columns) -> tuple[ArrayLike, float, float]:
    """Bounding sphere of an element, body axes, and half its thickness; infinite for a plane."""
    if hasattr(surface.module, "bounding"):
        return *surface.module.bounding(element), surface.module.half_thickness(element)
    return element["point"], inf, inf


# number of a card, floor of speeds, order of the sides, names of the surfaces on each, those on
# both, and rows of laws by classes of radii
NamedBlock = tuple[int, float, int, tuple[list[str], ...], set[str], dict[tuple[int, int], int]]


class GroupBuilder:
    """Collects the pairs that share gap routine and laws."""

    def __init__(self, word: str, gap_module: ModuleType, laws: list[Card]) -> None:
        self.word, self.gap_module = word, gap_module
        self.modules: list[ModuleType] = [import_module(type(law).__module__) for law in laws]
        self.sides = (Side("a"), Side("b"))
        self.laws: list[Columns] = []
        self.blocks: list[NamedBlock] = []

    def add(
        self,
        index: int,
        entry: Entry,
        narrow: ModuleType,
        swapped: bool,
        surfaces: tuple[list[Surface], list[Surface]],
        on_both: set[str],
        scene: Scene,
    ) -> None:
        """All pairs of surfaces of two shapes under one card."""
        ordered = (surfaces[1], surfaces[0]) if swapped else surfaces
        for side, some in zip(self.sides, ordered, strict=True):
            for surface in some:
                side.assign(surface, narrow)
        rows: dict[tuple[int, int], int] = {}
        for a, b in _different(surfaces):
            first, second = (b, a) if swapped else (a, b)
            rows[self.sides[0].round_of(first), self.sides[1].round_of(second)] = len(self.laws)
            self.laws.append(self._law(entry, a, b, scene))
        names = tuple([s.entry.name for s in some] for some in ordered)
        order = -1 if swapped else 1
        floor = speed_floor(entry.card, scene)
        self.blocks.append((index, floor, order, names, on_both, rows))

    def _law(self, entry: Entry, a: Surface, b: Surface, scene: Scene) -> Columns:
        """Parameters of the laws between two surfaces."""
        first, *others = _laws(entry.card)
        scene.refuse_stepwise(self.modules[0])
        law = self.modules[0].build(first, scene, Pair(entry.name, a.radius, b.radius))
        refuse_different(self.modules[0], self.modules[0].PARAMETERS, law)
        for module, card in zip(self.modules[1:], others, strict=True):
            scene.refuse_stepwise(module, "friction")
            own = module.build(card, scene)
            refuse_different(module, module.PARAMETERS, own)
            law = law | own
        if _torsion_radius(entry.card) is not None:
            law = law | {"torsion_radius": entry.card.torsion_radius}
        return dict(law)

    def finish(self, nodes: dict[str, np.ndarray], is_implicit: bool) -> ContactGroup:
        """The group with its pairs, all of them or the near ones."""
        parameters, history = records.PARAMETERS, records.HISTORY
        if self._have_ends():
            history = history + records.FACE_HISTORY
            if hasattr(self.gap_module, "search"):
                history = history + records.EXIT_LEAD
        for module in self.modules:
            parameters, history = parameters + module.PARAMETERS, history + module.HISTORY
        if "torsion_radius" in self.laws[0]:
            parameters = parameters + records.TORSION
        if hasattr(self.gap_module, "IS_DISTANCE"):
            parameters = parameters + records.RESTING
        if len(self.modules) > 1 and (
            "torsion_radius" in self.laws[0] or hasattr(self.gap_module, "patch")
        ):
            history = history + records.SPIN_RADIUS
        if hasattr(self.modules[0], "rate_slope") and hasattr(self.gap_module, "patch"):
            history = history + records.PRESSURE
        elements = (self.sides[0].elements, self.sides[1].elements)
        # the arrays of all elements come first: they may note in an element where its part starts
        data = getattr(self.gap_module, "data", lambda *_: ())(*elements)
        pairing = self._pairing(parameters)
        search = Search(pairing) if pairing.should_search(is_implicit) else None
        rows = pairing.everything() if search is None else search.update(nodes)
        return ContactGroup(
            word=self.word,
            narrow=cast(StepGap, self.gap_module),
            normal=cast(NormalLaw, self.modules[0]),
            friction=cast(StepFriction, self.modules[1]) if len(self.modules) > 1 else None,
            elements_a=_table(elements[0], self.sides[0].record),
            elements_b=_table(elements[1], self.sides[1].record),
            data=data,
            parameters=rows,
            history=resting(len(rows), history.dtype, search),
            output=np.zeros(len(rows), records.OUTPUT.dtype),
            search=search,
        )

    def _have_ends(self) -> bool:
        """Whether there are sides that a body may pass the middle of; impulses let none pass."""
        thick = (side.arrays().thick for side in self.sides)
        return hasattr(self.modules[0], "normal_force") and all(
            bool(np.isfinite(t).any()) for t in thick
        )

    def _pairing(self, parameters: Record) -> Pairing:
        first, second = (side.arrays() for side in self.sides)
        laws = np.zeros(len(self.laws), parameters.dtype)
        for row, values in zip(laws, self.laws, strict=True):
            for name, value in values.items():
                row[name] = value
        blocks = []
        for index, floor, order, names, on_both, rows in self.blocks:
            law = np.zeros((first.round.max() + 1, second.round.max() + 1), int)
            for classes, row in rows.items():
                law[classes] = row
            member = self.sides[0].mask(names[0]), self.sides[1].mask(names[1])
            twice = self.sides[0].mask(on_both), self.sides[1].mask(on_both)
            blocks.append(Block(index, floor, order, member, twice, law))
        return Pairing((first, second), blocks, laws)


def _different(surfaces: tuple[list[Surface], list[Surface]]) -> list[tuple[Surface, Surface]]:
    """One pair of surfaces for every two radii of curvature: their laws are the same."""
    some_a, some_b = ({str(s.radius): s for s in side}.values() for side in surfaces)
    return [(a, b) for a in some_a for b in some_b]


def _table(rows: list[Columns], record: Record | None) -> np.ndarray:
    assert record is not None
    table = np.zeros(len(rows), record.dtype)
    for i, values in enumerate(rows):
        for column in record.columns:
            table[i][column.name] = values[column.name]
    return table
