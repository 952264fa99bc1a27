"""Model: what never changes during a run. State: all that changes. Both are arrays with meaning."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from crashsolve.foundation.saddle import Saddle


@dataclass
class Group:
    """All entries of one type: `module` holds the kernels, one row of each array is one entry."""

    keyword: str
    type: str
    module: Any
    names: list[str]
    parameters: np.ndarray
    history: np.ndarray  # (2, n): accepted and new, see clock.current
    output: np.ndarray
    members: np.ndarray | None = None  # points that its entries act on, one after the other

    @property
    def word(self) -> str:
        """Name of the group in the composed step."""
        return f"{self.keyword}_{self.type}"


@dataclass
class ContactGroup:
    """All contact pairs of one gap routine, one normal law and one friction law."""

    word: str
    narrow: Any
    normal: Any
    friction: Any | None
    elements_a: np.ndarray
    elements_b: np.ndarray
    data: tuple[Any, ...]
    parameters: np.ndarray
    history: np.ndarray
    output: np.ndarray
    search: Any | None  # of the near pairs; None when all pairs are kept

    @property
    def captures(self) -> bool:
        """Whether its law is a constraint instead of a force."""
        return not hasattr(self.normal, "normal_force")

    @property
    def has_shares(self) -> bool:
        """Whether an element of side a has a share of the force of the law only."""
        return "share" in (self.elements_a.dtype.names or ())

    @property
    def is_flat(self) -> bool:
        """Whether the sides press on each other over an area."""
        return hasattr(self.narrow, "patch")

    @property
    def has_radius(self) -> bool:
        """Whether its cards give a radius with which friction resists a spin."""
        return "torsion_radius" in (self.parameters.dtype.names or ())

    @property
    def resists_spin(self) -> bool:
        """Whether friction has a torque about the normal."""
        return self.friction is not None and (self.is_flat or self.has_radius)


@dataclass
class NodalGroup:
    """Nodes of shells on a shape, or nodes and balls on the faces of a shell, under one card."""

    word: str
    card: str
    narrow: Any | None  # gap routine of a shape; None for faces
    normal: Any
    friction: Any | None
    arrays: dict[str, np.ndarray]  # see model/nodal.py
    is_smooth: bool = False  # normals of faces from a continuous field
    can_fail: bool = False  # whether faces may vanish

    # what a run writes, and what grows with it
    CHANGING: ClassVar = ("p", "slots", "turns", "tally", "due", "first", "near", "wait", "gone")

    @property
    def has_ends(self) -> bool:
        """Whether nodes press on shapes that they may pass the middle of."""
        return "passed" in (self.arrays["slots"].dtype.names or ())

    @property
    def is_round(self) -> bool:
        """Whether ellipsoids press."""
        return "ellipsoids" in self.arrays

    def changing(self) -> dict[str, np.ndarray]:
        """Arrays that a restart must bring back."""
        return {name: self.arrays[name] for name in self.CHANGING if name in self.arrays}


@dataclass
class Joint:
    """Where one joint's rows are and what they join; the point and axis in body axes."""

    name: str
    type: str
    nodes: tuple[int, ...]  # a and b; and two for each further part of the rows
    first_row: int
    rows: int  # of each part
    angular: tuple[bool, ...]
    frame: dict[str, Any]

    @property
    def node_a(self) -> int:
        return self.nodes[0]

    @property
    def node_b(self) -> int:
        return self.nodes[1]

    @property
    def parts(self) -> int:
        return len(self.nodes) // 2


@dataclass
class Elements:
    """Where the elements of parts with points are: corners, riders, room between loops."""

    corners: np.ndarray
    riders: np.ndarray
    work: np.ndarray
    parts: dict[str, Any]  # in place, by name
    point_mass: float  # of the points that ride on no body of the deck
    taps: np.ndarray  # elements of sections, block by block, see parts/_cut.py
    cuts: np.ndarray
    motion: np.ndarray  # momenta of the points at the last sample
    halves: Any = None  # for two threads, see model/halves.py
    # points with bodies behind those that have names, for implicit integrators
    embodied: np.ndarray = field(default_factory=lambda: np.zeros(0, int))


@dataclass
class Model:
    """Everything a run reads and never writes."""

    title: str
    bodies: list[str]  # node names; the first is the ground
    mass: np.ndarray
    slaves: np.ndarray  # nodes welded to rigid bodies
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
    surfaces: dict[str, Any]
    elements: Elements | None = None
    nodal_groups: list[NodalGroup] = field(default_factory=list)
    nodal_loads: dict[str, np.ndarray] = field(default_factory=dict)  # of all these groups

    def joint_groups(self) -> list[Group]:
        """Joints, and hinges, which are joints with a law of force."""
        return [g for g in self.groups if hasattr(g.module, "residual")]

    def force_groups(self) -> list[Group]:
        return [g for g in self.groups if hasattr(g.module, "force")]

    def piecewise_groups(self) -> list[Group]:
        """Laws of several pieces that can say how far they are past the one they were on."""
        return [g for g in self.groups if hasattr(g.module, "beyond")]

    def rubbing_groups(self) -> list[ContactGroup]:
        """Contacts whose friction can say how far it is past the regime it was in."""
        return [c for c in self.contact_groups if hasattr(c.friction, "regime_left")]

    def total_mass(self) -> float:
        """Of bodies and points [kg]."""
        return float(self.mass.sum()) + (self.elements.point_mass if self.elements else 0.0)

    def element_groups(self) -> list[Group]:
        """Parts whose elements are kept in blocks."""
        return [g for g in self.groups if hasattr(g.module, "deform")]

    def element_name(self, number: int) -> str:
        """Name of an element: of its part, and counted there from 1."""
        name, row = self._last_part("first_element", number)
        return f"{name}_{number - row['first_element'] + 1}"

    def element_with_node(self, number: int) -> str:
        """Name of an element, and that of its nodes with the least mass."""
        name, row = self._last_part("first_element", number)
        assert self.elements is not None
        laid = self.elements.parts[name]
        corners = laid.mesh.quads[number - row["first_element"]]
        lightest = corners[np.argmin(laid.mass[corners])]
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

    def part_at(self, place: int) -> str:
        """The part whose point a place behind those of the bodies is."""
        point = place - len(self.bodies)
        if self.elements and len(self.elements.embodied):
            point = int(self.elements.embodied[point])
        name, row = self._last_part("first_point", point)
        return f"part '{name}', node {point - row['first_point'] + 1}"

    def _last_part(self, column: str, number: int) -> tuple[str, Any]:
        """The part in which a number lies that `column` begins."""
        rows = [
            (name, row)
            for g in self.element_groups()
            for name, row in zip(g.names, g.parameters, strict=True)
        ]
        return next((name, row) for name, row in reversed(rows) if row[column] <= number)

    def sensor_groups(self) -> list[Group]:
        return [g for g in self.groups if g.keyword == "sensors"]

    def element_loads(self) -> list[Group]:
        """Loads on the elements of parts, half by half."""
        return [g for g in self.groups if hasattr(g.module, "load_half")]

    def following_groups(self) -> list[Group]:
        """Sensors that must look at every step."""
        return [g for g in self.sensor_groups() if hasattr(g.module, "follow")]


@dataclass
class State:
    """Everything a run writes, with the histories of the groups; a restart dump is exactly this."""

    clock: np.ndarray
    nodes: np.ndarray
    rows: np.ndarray
    cards: np.ndarray
    card_history: np.ndarray
    ledger: np.ndarray
    points: np.ndarray  # nodes of shells, see foundation/point.py
    blocks: np.ndarray  # what their elements keep
    stages: np.ndarray  # of a Runge-Kutta step, from which the next may begin its iteration
