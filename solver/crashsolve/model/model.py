"""Model: the constant data of a run. State: all that changes. Both are arrays with meaning."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from itertools import accumulate
from types import ModuleType
from typing import TYPE_CHECKING, ClassVar, cast

import numpy as np

from crashsolve.deck.roles import BasicConstraint, FibreLaw, StepLaw
from crashsolve.foundation.sparse.saddle import Saddle
from crashsolve.model import ledger
from crashsolve.model.contact.groups import ContactGroup, NodalGroup
from crashsolve.model.phases import Phase
from crashsolve.model.tables import present_tables

if TYPE_CHECKING:
    from collections.abc import Mapping

    from crashsolve.deck.building import Columns, SurfaceOfScene
    from crashsolve.elements.shells.layout import DiscretisedShell


@dataclass(eq=False)
class Group:
    """All entries of one type: `module` holds the kernels, one row of each array is one entry."""

    TABLES: ClassVar = (
        "parameters",
        "history",
        "output",
        "members",
        "pieces",
        "spans",
        "powers",
        "data",
    )

    keyword: str
    type: str
    module: ModuleType
    names: list[str]
    parameters: np.ndarray
    history: np.ndarray  # (2, n): accepted and new, see clock.current
    output: np.ndarray
    members: np.ndarray | None = None  # points that its entries act on, one after the other
    pieces: np.ndarray | None = None  # the parameters of pieces of its entries, for several threads
    spans: np.ndarray | None = None  # which of these are an entry's, of loads on elements
    materials: tuple[tuple[int, ModuleType], ...] = ()  # laws that its kernels call, by p.law
    powers: np.ndarray | None = None  # of all stages of a step with dense output, entry by entry
    data: tuple[np.ndarray, ...] = ()  # further tables that its kernels read, see shared_tables

    @property
    def word(self) -> str:
        """Name of the group in the composed step."""
        return f"{self.keyword}_{self.type}"

    def tables(self) -> dict[str, np.ndarray]:
        """Arrays of the group in the composed step."""
        return present_tables(self)

    @property
    def law(self) -> StepLaw:
        """Module of its kernels."""
        return cast(StepLaw, self.module)

    @property
    def constraints(self) -> tuple[tuple[BasicConstraint, int], ...]:
        """Basic constraints of a joint, each with the position of its first row among the
        joint's.
        """
        basic = self.module.CONSTRAINTS
        first = accumulate((len(b.ANGULAR) for b in basic), initial=0)
        return tuple(zip(basic, first, strict=False))

    @property
    def has_own_rows(self) -> bool:
        """Whether a joint has more rows than those."""
        return hasattr(self.module, "residual")

    @property
    def can_separate(self) -> bool:
        """Whether a joint may fail and release its bodies."""
        return hasattr(self.module, "release_rows")

    @property
    def fibre_law(self) -> FibreLaw:
        """The module as one whose fibres call a law of `materials`."""
        return cast(FibreLaw, self.module)

    @property
    def kinds(self) -> tuple[ModuleType, ...]:
        """Modules with the kernels of those kinds of elements that there are."""
        return tuple(kind for _, kind in self.numbered_kinds)

    @property
    def numbered_kinds(self) -> tuple[tuple[int, ModuleType], ...]:
        """Modules of the kinds of elements with their positions among all kinds."""
        return tuple(
            (number, self._within(f"{self.module.KERNELS}.{name}"))
            for number, (column, name) in enumerate(self.module.KINDS.items())
            if self.parameters[column].any()
        )

    @property
    def tangent_kinds(self) -> tuple[ModuleType, ...]:
        """Modules with the tangents of those kinds."""
        leaves = (kind.__name__.rpartition(".")[2] for kind in self.kinds)
        return tuple(self._within(f"{self.module.SLOPES}.{leaf}") for leaf in leaves)

    @property
    def blocks(self) -> ModuleType:
        """Module that takes elements of any kind block by block."""
        return self._within(f"{self.module.KERNELS}.blocks")

    @property
    def slopes(self) -> ModuleType:
        """Module that computes the tangents of elements of any kind block by block."""
        return self._within(f"{self.module.SLOPES}.blocks")

    def _within(self, name: str) -> ModuleType:
        """A module of the solver by its name within the package."""
        return import_module(f"crashsolve.{name}")

    @property
    def tangent_parts(self) -> int:
        """Rows of two bodies each that every row of its tangents is made of."""
        return self.max_nodes // 2 if self.joins_several else 1

    @property
    def joins_several(self) -> bool:
        """Whether an entry acts on any number of bodies: `node` then is a column of several."""
        return self.max_nodes > 0

    @property
    def max_nodes(self) -> int:
        """Entries of that column; 0 for a law without one."""
        names = self.parameters.dtype.names or ()
        shape = self.parameters.dtype["node"].shape if "node" in names else ()
        return int(shape[0]) if shape else 0

    @property
    def tangent_rows(self) -> int:
        """Rows of the tangents of an entry, with all their parts."""
        return int(self.module.TANGENTS * self.tangent_parts)

    @property
    def has_work(self) -> bool:
        """Whether plastic work is distinguished from other losses."""
        return "work" in (self.history.dtype.names or ())

    @property
    def is_watched(self) -> bool:
        """Whether its laws are judged by the work that they do, see system/gain.py."""
        return "initially_stored" in (self.history.dtype.names or ())

    @property
    def stored_entry(self) -> int:
        """Entry of the ledger for the energy that its laws store."""
        return ledger.entries_of(self)[0]

    @property
    def lost_entry(self) -> int | None:
        """Entry of the ledger for the losses of its laws; None where nothing can be lost."""
        return ledger.entries_of(self)[1]

    @property
    def works_from_outside(self) -> bool:
        """Whether what its laws lose is work from outside, as that of loads."""
        return self.lost_entry == ledger.EXTERNAL_WORK


@dataclass(eq=False)
class Joint:
    """Rows of one joint, and its bodies; its point and axis in body axes."""

    name: str
    type: str
    nodes: tuple[int, ...]  # a and b; and two for each further part of the rows
    first_row: int
    rows: int  # of each part
    angular: tuple[bool, ...]
    frame: Columns

    @property
    def node_a(self) -> int:
        return self.nodes[0]

    @property
    def node_b(self) -> int:
        return self.nodes[1]

    @property
    def parts(self) -> int:
        return len(self.nodes) // 2


@dataclass(eq=False)
class Pieces:
    """Tables that several threads need beside those of one."""

    rows: dict[str, np.ndarray]  # parameters of parts, and of loads on them, by word, a piece each
    spans: dict[str, np.ndarray]  # which of these are an entry's, of loads
    pieces: np.ndarray
    points: np.ndarray  # all of them, replicas at the end
    originals: np.ndarray  # for which

    @property
    def replicas(self) -> np.ndarray:
        """Points that collect forces for others."""
        return self.points[len(self.points) - len(self.originals) :]


@dataclass(eq=False)
class Elements:
    """Tables of the elements of parts with points: corners, attached points, work space."""

    corners: np.ndarray
    attached_points: np.ndarray
    work: np.ndarray
    parts: dict[str, DiscretisedShell]  # in place, by name
    point_mass: float  # of the points that are attached to no body of the deck
    element_cuts: (
        np.ndarray
    )  # elements of sections, block by block, see elements/shells/section_cut.py
    cuts: np.ndarray
    motion: np.ndarray  # momenta of the points at the last sample
    ties: np.ndarray  # points that are tied to faces
    holds: np.ndarray = field(default_factory=lambda: np.zeros(0))  # points that are held
    block_sums: np.ndarray = field(default_factory=lambda: np.zeros(0))  # of loads on elements
    pieces: Pieces | None = None  # for several threads, see model/partition.py
    # points with bodies behind those that have names, for implicit integrators
    node_points: np.ndarray = field(default_factory=lambda: np.zeros(0, int))


@dataclass(eq=False)
class Model:
    """Everything a run reads and never writes."""

    title: str
    bodies: list[str]  # node names; the first is the ground
    mass: np.ndarray
    attached_nodes: np.ndarray  # nodes welded to rigid bodies
    mass_centres: np.ndarray  # of bodies from their origins, body axes [m]
    size: float  # model length for tolerances [m]
    integrator: str
    choice: str  # why that one, where the deck leaves it open
    groups: list[Group]
    contact_groups: list[ContactGroup]
    contacts: list[str]  # contact cards
    joints: list[Joint]
    curves: np.ndarray
    curve_names: dict[str, int]
    saddle: Saddle
    control: np.ndarray
    warnings: list[str]
    citations: list[str]
    surfaces: Mapping[str, SurfaceOfScene]
    elements: Elements | None = None
    nodal_groups: list[NodalGroup] = field(default_factory=list)
    nodal_loads: dict[str, np.ndarray] = field(default_factory=dict)  # of all these groups
    threads: int = 1  # that share its steps
    phases: list[Phase] = field(default_factory=list)

    def joint_groups(self) -> list[Group]:
        """Groups with constraint rows."""
        return [g for g in self.groups if hasattr(g.module, "CONSTRAINTS")]

    def force_groups(self) -> list[Group]:
        return [g for g in self.groups if hasattr(g.module, "force")]

    def branching_groups(self) -> list[Group]:
        """Laws of several branches, with an event function that states where one ends."""
        return [g for g in self.groups if hasattr(g.module, "event")]

    def branching_contacts(self) -> list[ContactGroup]:
        """Contacts whose normal force or friction can say how far it is past its branch."""
        return [
            c
            for c in self.contact_groups
            if hasattr(c.normal, "branch_left") or hasattr(c.friction, "regime_left")
        ]

    def total_mass(self) -> float:
        """Mass of all bodies and points [kg]."""
        return float(self.mass.sum()) + (self.elements.point_mass if self.elements else 0.0)

    def element_groups(self) -> list[Group]:
        """Parts whose elements are kept in blocks."""
        return [g for g in self.groups if hasattr(g.module, "KINDS")]

    def element_name(self, number: int) -> str:
        """Name of an element: of its part, and counted there from 1."""
        name, row = self._part_of(number)
        return f"{name}_{number - row['first_element'] + 1}"

    def _part_of(self, element: int) -> tuple[str, np.void]:
        """Name and row of the part with an element."""
        rows = reversed(self._rows_of_parts())
        return next((name, row) for name, row in rows if row["first_element"] <= element)

    def element_with_node(self, number: int) -> str:
        """Name of an element, and that of its nodes with the least mass."""
        name, row = self._part_of(number)
        assert self.elements is not None
        meshed = self.elements.parts[name]
        corners = meshed.mesh.quads[number - row["first_element"]]
        lightest = corners[np.argmin(meshed.mass[corners])]
        return f"{self.element_name(number)}, node {lightest + 1}"

    def node_with_element(self, node: int) -> str:
        """Name of a body; of a part's node with that of its stiffest element."""
        fastest, words = 0.0, self.bodies[node]
        for g in self.groups:
            if g.keyword != "parts" or "node_a" not in (g.parameters.dtype.names or ()):
                continue
            for end in "ab":
                for i in np.flatnonzero(g.parameters[f"node_{end}"] == node):
                    rate = float(g.parameters[f"rate_{end}"][i])
                    if rate > fastest:
                        fastest, words = rate, f"{g.names[i]}, node {self.bodies[node]}"
        return words

    def part_at(self, index: int) -> str:
        """The part whose point a position behind those of the bodies is."""
        point = index - len(self.bodies)
        if self.elements and len(self.elements.node_points):
            point = int(self.elements.node_points[point])
        name, row = next(
            (name, row)
            for name, row in self._rows_of_parts()
            if row["first_point"] <= point < row["first_point"] + row["point_count"]
        )
        return f"part '{name}', node {point - row['first_point'] + 1}"

    def _rows_of_parts(self) -> list[tuple[str, np.void]]:
        """Names and rows of the parts with points."""
        return [
            (name, row)
            for g in self.element_groups()
            for name, row in zip(g.names, g.parameters, strict=True)
        ]

    def sensor_groups(self) -> list[Group]:
        """Groups that are read at samples."""
        return [g for g in self.groups if hasattr(g.module, "measure")]

    def element_loads(self) -> list[Group]:
        """Loads on the elements of parts kept in blocks."""
        return [g for g in self.groups if hasattr(g.module, "load_elements")]

    def following_groups(self) -> list[Group]:
        """Sensors that are evaluated in every step."""
        return [g for g in self.sensor_groups() if hasattr(g.module, "follow")]


@dataclass(eq=False)
class State:
    """Everything a run writes, with the histories of the groups; a restart dump is exactly this."""

    clock: np.ndarray
    nodes: np.ndarray
    rows: np.ndarray
    cards: np.ndarray
    card_history: np.ndarray
    ledger: np.ndarray
    points: np.ndarray  # nodes of shells, see foundation/point.py
    blocks: np.ndarray  # history of their elements
    stages: np.ndarray  # of a Runge-Kutta step, from which the next may begin its iteration
