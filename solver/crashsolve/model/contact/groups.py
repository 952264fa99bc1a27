"""Groups of contacts in the composed step: of pairs of elements, and of nodes on surfaces."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from crashsolve.deck.roles import NormalLaw, StepFriction, StepGap
from crashsolve.model.tables import present_tables

# rows of the matrix of an implicit step, of one contact pair: friction along the slip and across
# it, twice across where it resists a spin too; torques against tilting about both tangents
FRICTION_ROWS, SPIN_ROWS, TILT_ROWS = 2, 3, 2


def is_damper(friction: object) -> bool:
    """Whether friction depends on the sliding speed alone, so that a step can reverse it."""
    return friction is not None and not getattr(friction, "STEPWISE", False)


class NearPairs(Protocol):
    """The list of near pairs of a group (model/contact/pairs.py)."""

    references: tuple[np.ndarray, ...]  # of both sides, when the list was made
    slack: np.ndarray
    margin: float  # beyond the gap [m]

    @property
    def laws(self) -> np.ndarray:
        """Parameters of the laws, by kind of pair."""

    def cards(self) -> list[int]:
        """Contact cards whose pairs are in the list."""

    def arrays(self) -> dict[str, np.ndarray]:
        """Arrays from which the step determines when pairs must be searched again."""

    def update(self, nodes: np.ndarray) -> np.ndarray:
        """Parameters of the near pairs now. Writes: references."""


class Touching:
    """Properties of a group of contacts by its laws; a group has a gap routine, friction,
    histories.
    """

    narrow: StepGap | None
    normal: NormalLaw
    friction: StepFriction | None

    @property
    def has_ends(self) -> bool:
        """Whether a contact may end on the other side of its partner."""
        raise NotImplementedError

    @property
    def keeps_faces(self) -> bool:
        """Whether contact may continue with another face than the nearest."""
        return self.has_ends and hasattr(self.narrow, "gap_by")

    @property
    def has_core_depth(self) -> bool:
        """Whether its gap routine has the depth of the middle of a round face."""
        return self.keeps_faces and hasattr(self.narrow, "middle")

    @property
    def friction_damps(self) -> bool:
        """Whether friction depends on the sliding speed alone, so that a step can reverse it."""
        return is_damper(self.friction)


@dataclass(eq=False)
class ContactGroup(Touching):
    """All contact pairs of one gap routine, one normal law and one friction law."""

    TABLES: ClassVar = (
        *("parameters", "history", "output", "elements_a", "elements_b", "data"),
        *("reference_a", "reference_b", "slack"),
        *("pieces", "sums", "counts", "loads", "applied", "load_rows", "loaded_bodies", "ranges"),
        "body_pairs",
    )

    word: str
    narrow: StepGap
    normal: NormalLaw
    friction: StepFriction | None
    elements_a: np.ndarray
    elements_b: np.ndarray
    data: tuple[np.ndarray, ...]
    parameters: np.ndarray
    history: np.ndarray
    output: np.ndarray
    search: NearPairs | None  # of the near pairs; None when all pairs are kept
    # of many pairs, see model/contact/pieces.py
    pieces: np.ndarray | None = None
    sums: np.ndarray | None = None  # of a piece, as a card has them
    counts: np.ndarray | None = None
    loads: np.ndarray | None = None  # on bodies, body by body
    applied: np.ndarray | None = None  # whether there is such a load now
    load_rows: np.ndarray | None = (
        None  # of pair i those of loads 2 i on side a and 2 i + 1 on side b
    )
    loaded_bodies: np.ndarray | None = None
    ranges: np.ndarray | None = None  # pieces of the bodies
    # of few pairs that are skipped while separated: model/contact/body_pairs.py
    body_pairs: np.ndarray | None = None

    @property
    def in_pieces(self) -> bool:
        """Whether its pairs are many, and done in pieces."""
        return self.pieces is not None

    @property
    def is_unilateral(self) -> bool:
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
    def loses_work(self) -> bool:
        """Whether the loss of its normal force is the work of a step less the change of stored
        energy.
        """
        return hasattr(self.normal, "LOSS_IS_WORK") and not self.is_flat

    @property
    def resolves_damping(self) -> bool:
        """Whether its normal force can be that of the closing speed to which it leads."""
        return hasattr(self.normal, "rate_slope")

    @property
    def has_radius(self) -> bool:
        """Whether its cards give a radius with which friction resists a spin."""
        return "torsion_radius" in (self.parameters.dtype.names or ())

    @property
    def resists_spin(self) -> bool:
        """Whether friction has a torque about the normal."""
        return self.friction is not None and (self.is_flat or self.has_radius)

    @property
    def has_ends(self) -> bool:
        """Whether pairs remember their exit."""
        return "pass_time" in (self.history.dtype.names or ())

    @property
    def skips(self) -> bool:
        """Whether a pair is skipped until it may have moved as far as its gap."""
        return "reach_a" in (self.parameters.dtype.names or ()) and not self.is_unilateral

    @property
    def follows_exit(self) -> bool:
        """Whether a contact follows its exit, and others are searched from time to time."""
        return "remaining_lead" in (self.history.dtype.names or ())

    @property
    def bounds_next_step(self) -> bool:
        """Whether the next step must be cut: a list to renew, or sides with an end."""
        return self.search is not None or bool(np.isfinite(self.parameters["thick"]).any())

    @property
    def tangent_rows(self) -> int:
        """Rows of one pair for implicit methods: of the normal force, of tilting, of friction."""
        friction_row_count = (
            (SPIN_ROWS if self.resists_spin else FRICTION_ROWS) if self.friction else 0
        )
        return 1 + (TILT_ROWS if self.is_flat else 0) + friction_row_count

    # where elements were when the list of near pairs was made, and how far they may go

    @property
    def reference_a(self) -> np.ndarray | None:
        return self.search.references[0] if self.search else None

    @property
    def reference_b(self) -> np.ndarray | None:
        return self.search.references[1] if self.search else None

    @property
    def slack(self) -> np.ndarray | None:
        return self.search.slack if self.search else None

    def tables(self) -> dict[str, np.ndarray]:
        """Arrays of the group in the composed step."""
        return present_tables(self)


@dataclass(eq=False)
class NodalGroup(Touching):
    """Nodes of shells on a shape, or nodes and balls on the faces of a shell, under one card."""

    word: str
    card: str
    narrow: StepGap | None  # gap routine of a shape; None for faces
    normal: NormalLaw
    friction: StepFriction | None
    arrays: dict[str, np.ndarray]  # see model/contact/node_to_surface.py
    is_smooth: bool = False  # normals of faces from a continuous field
    can_fail: bool = False  # whether elements may be deleted

    # outputs of a run
    CHANGING: ClassVar = (
        "p",
        "probe_states",
        "slot_in_use",
        "totals",
        "due",
        "first",
        "near",
        "wait",
        "deleted",
        "balls",
    )

    @property
    def has_ends(self) -> bool:
        """Whether nodes press on shapes that they may pass the middle of."""
        return "pass_time" in (self.arrays["probe_states"].dtype.names or ())

    @property
    def is_self_contact(self) -> bool:
        """Whether nodes of a shell press on faces of its own."""
        rows = self.arrays["p"]
        is_own = "is_self_contact" in (rows.dtype.names or ()) and bool(rows["is_self_contact"][0])
        return self.narrow is None and is_own

    def balls_between_faces(self) -> int:
        """Number of balls on bodies that lie between three faces or more."""
        if self.narrow is not None:
            return 0
        balls = np.flatnonzero(self.arrays["probes"]["point"] < 0)
        in_use, states = self.arrays["slot_in_use"], self.arrays["probe_states"]
        rows = np.concatenate([2 * balls, 2 * balls + 1])
        # one that waits for acceptance is that of the last step: node_contact.accept_record
        last = np.where(in_use[rows] > 1, 3 - in_use[rows], in_use[rows])
        now = states[last, rows]
        return int(((now["active"] == 1) & (now["other_walls"] > 1)).sum())

    @property
    def depth_and_middle(self) -> tuple[float, float]:
        """Deepest penetration so far, and the distance from the surface to the middle [m]."""
        p = self.arrays["p"][0]
        # of faces, the probe and half of the shell
        middle = p["gap"] if self.narrow is None else p["thick"]
        return float(self.arrays["totals"]["deepest"][0]), float(middle)

    @property
    def is_round(self) -> bool:
        """Whether ellipsoids press."""
        return "ellipsoids" in self.arrays

    def __getattr__(self, name: str) -> Any:
        arrays = self.__dict__.get("arrays", {})
        if name == "data":
            return tuple(array for key, array in arrays.items() if key.startswith("data_"))
        if name in arrays:
            return arrays[name]
        raise AttributeError(name)

    @property
    def TABLES(self) -> tuple[str, ...]:
        return (*self.arrays, "data")

    def tables(self) -> dict[str, np.ndarray]:
        """Arrays of the group in the composed step."""
        return self.arrays

    def changing(self) -> dict[str, np.ndarray]:
        """Arrays that a restart must restore."""
        return {name: self.arrays[name] for name in self.CHANGING if name in self.arrays}


def thinnest_of(groups: Iterable[ContactGroup]) -> float:
    """Least half thickness of two sides of contacts, or slack of a list of pairs [m]; else inf."""
    thick = [float(group.parameters["thick"].min()) for group in groups if not group.search]
    slack = [float(group.search.slack[0]) for group in groups if group.search]
    return min(thick + slack, default=np.inf)
