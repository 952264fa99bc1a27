"""Scene: nodes, frames, curves and errors for the `build` of laws, while cards become numbers.

Frames: a body's own axes and origin are those of its card; inside, points are measured from the
mass centre. Joints are placed at the start of the run, in world axes or in those of a body.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from itertools import takewhile
from math import hypot, inf
from typing import TYPE_CHECKING, Any

import numpy as np

from crashsolve.compiler.machine import runs_plain
from crashsolve.deck.building import Columns
from crashsolve.foundation.distinct import distinct

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType

    from numpy.typing import ArrayLike

    from crashsolve.deck.building import (
        AboutAxis,
        Attached,
        Jointed,
        JointOfScene,
        Meshed,
        PartOfScene,
        SurfaceOfScene,
    )
    from crashsolve.elements.shells.cards import Weld
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.meshes._mesh import Mesh
from crashsolve.deck.card import law_class
from crashsolve.deck.family import CHOSEN, families
from crashsolve.deck.laws import types_in
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.foundation.orientation import crosses, matrix, perpendicular
from crashsolve.model import attachments as welds
from crashsolve.model import shared_mesh
from crashsolve.model.checks.finite import BEYOND, BEYOND_NUMBERS
from crashsolve.model.checks.postures import torn_joints
from crashsolve.model.ties import tie_nodes

if TYPE_CHECKING:
    from crashsolve.deck.reading.deck import Deck
    from crashsolve.deck.reading.items import Entry

Vector = np.ndarray


class CardProblem(ValueError):
    """A card that cannot be built; `field` names the word of the deck to point at."""

    def __init__(self, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.field = field


class Scene:
    """Names, configurations and helpers during the build of one deck."""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        self.warnings: list[str] = []
        self.errors: list[DeckError] = []
        self.stepwise: list[str] = []  # laws that count in whole steps
        self.methods: list[str] = []  # integrators of all families; empty for any
        self.joints: dict[str, JointOfScene] = {}
        # of hinges, by their names and fields
        self.backbones: dict[str, dict[str, Any]] = {}
        self.under_way = ""  # name of the entry that is being built
        self.surfaces: Mapping[str, SurfaceOfScene] = {}
        self.names = ["ground", *deck.entries["bodies"]]
        self.part_nodes: dict[str, list[int]] = {}  # of each part
        for part in deck.entries["parts"].values():
            names = part.card.node_names(part.name)
            self.part_nodes[part.name] = list(range(len(self.names), len(self.names) + len(names)))
            self.names += names
        self._index = {name: i for i, name in enumerate(self.names)}
        self.curves: dict[str, int] = {}
        self.curve_points = np.zeros(0)  # all curves, as kernels read them
        n = len(self.names)
        self.mass = np.zeros(n)
        self.J = np.zeros((n, 9))
        self.r, self.v, self.w = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
        self.q = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
        self.A = np.tile(np.eye(3).ravel(), (n, 1))
        self.offset = np.zeros((n, 3))  # mass centre from the body's origin, body axes
        for i, entry in enumerate(deck.entries["bodies"].values(), start=1):
            with self.building(entry):
                self._set_body(i, import_module(entry.module_name).build(entry.card, self))
        self.welded: dict[int, int] = {}  # nodes that are part of a rigid body
        # [rad] of joints that a posture has turned from the zero posture
        self.angles_at_start: dict[str, float] = {}
        self.posed: dict[int, str] = {}  # bodies of postures, and the roots of these
        self._pose()
        self._meshed: dict[str, DiscretisedShell] = {}  # parts with points
        self._discretise()
        for part in deck.entries["parts"].values() if not self.errors else ():
            with self.building(part):
                nodes = self._part_bodies(part)
                for i, node in zip(self.part_nodes[part.name], nodes, strict=True):
                    self._set_body(i, node)
        for entry in deck.entries["bodies"].values():
            with self.building(entry):
                welds.weld(entry, self)
        for entry in deck.entries["bodies"].values():
            if entry.card.part_of is not None:
                with self.building(entry):
                    welds.join(entry, self)
        # of attached nodes, before points of shells take a part of it
        self.inertia_shares = welds.inertia_shares(self)
        self.attached: dict[str, list[tuple[int, int]]] = {}  # points of a part, and their bodies
        for part in deck.entries["parts"].values():
            with self.building(part):
                self.attached[part.name] = self.attach_points(part)
        self.size = self._model_size()

    def _pose(self) -> None:
        """Bodies of postures, positioned by their joint angles."""
        postures, r, A = self.deck.entries["postures"], self.r.copy(), self.A.copy()
        for entry in postures.values() if not self.errors else ():
            with self.building(entry):
                import_module(entry.module_name).build(entry.card, self)
        for word, joint, message in torn_joints(self, r, A) if postures and not self.errors else ():
            self.errors.append(self.deck.error(self.deck.entries[word][joint], "frame", message))

    def _discretise(self) -> None:
        """Put all parts with points in place, on their own meshes and on shared ones."""
        self._shares = shared_mesh.shared_meshes(self)
        for part in self.deck.entries["parts"].values() if not self.errors else ():
            module = import_module(part.module_name)
            if hasattr(module, "bodies"):
                with self.building(part):
                    self._meshed[part.name] = module.build(part.card, self)
        shared_mesh.join(self)
        self.point_count = shared_mesh.number_points([*self._with_points().values()])
        self.tied_mass = 0.0  # of nodes whose faces have it besides [kg]
        self.ties = tie_nodes(self)

    def _part_bodies(self, part: Entry) -> list[Columns]:
        """Nodes of a part that are bodies, a table of `_set_body` each."""
        module = import_module(part.module_name)
        if part.name in self._meshed:
            return module.bodies(self._meshed[part.name])
        return module.build(part.card, self)

    def own_share(self) -> Mesh:
        """Elements and points of a shared mesh that the part being built has."""
        return self._shares[self.under_way]

    def _set_body(self, i: int, body: Columns) -> None:
        self.mass[i] = body["mass"]
        self.J[i] = np.asarray(body["inertia"]).ravel()
        self.q[i] = body["quaternion"]
        self.A[i] = matrix(self.q[i]).ravel()
        self.offset[i] = body["mass_centre"]
        arm = matrix(self.q[i]) @ self.offset[i]
        self.w[i] = body["angular_velocity"]
        self.r[i] = np.asarray(body["position"]) + arm
        self.v[i] = np.asarray(body["velocity"]) + crosses(self.w[i], arm)

    def attach_points(self, part: Entry) -> list[tuple[int, int]]:
        """Points of a part that are part of bodies, with these; their masses go to the bodies."""
        pairs: list[tuple[int, int]] = []
        if self.errors:
            return pairs
        for k, weld in enumerate(getattr(part.card, "welded", ())):
            meshed = self.meshed(part.name)
            points = meshed.welded_points(k)
            others = self._weld_targets(weld, part, f"welded.{k}")
            x = meshed.mesh.points[points]
            gaps = np.linalg.norm(x[:, None] - self.r[None, others], axis=2)
            if weld.part:
                welds.check_reach(weld, meshed, points, gaps.min(axis=1), f"welded.{k}", self)
            nearest = np.asarray(others)[np.argmin(gaps, axis=1)]
            for body in distinct(nearest):
                own = points[nearest == body]
                welds.check_attached(meshed, own, int(body), f"welded.{k}", self)
                positions = meshed.mesh.points[own]
                welds.lump_points(int(body), positions, meshed.mass[own], meshed.J[own], self)
                pairs += [(int(point), int(body)) for point in own]
        return pairs

    def _weld_targets(self, weld: Weld, part: Entry, field: str) -> list[int]:
        """Bodies among which the nodes of a set find theirs."""
        some = [self._index[weld.to]] if weld.to else self.part_nodes[weld.part or ""]
        if 0 in some:
            raise self.fail("the ground holds nodes by `supports`", f"{field}.to")
        if weld.part == part.name or not some:
            raise self.fail("needs a part whose nodes are bodies, other than itself", field)
        return [self.welded.get(node, node) for node in some]

    def _model_size(self) -> float:
        """Extent of the bodies with their radii of gyration [m]."""
        # bodies that cannot be built have no size; they are refused before anyone asks for it
        if (len(self.names) < 2 and not self._meshed) or self.errors:
            return 1.0
        positions = [self.r[1:], *(meshed.mesh.points for meshed in self._meshed.values())]
        spread = np.ptp(np.concatenate(positions), axis=0).max()
        if len(self.names) < 2:
            return float(spread)
        trace = self.J[1:, 0] + self.J[1:, 4] + self.J[1:, 8]
        return float(max(spread, 2.0 * np.sqrt(0.5 * trace / self.mass[1:]).max()))

    @contextmanager
    def building(self, entry: Entry) -> Iterator[None]:
        """Collect the problems of one card, with its position in the deck."""
        before, self.under_way = self.under_way, entry.name
        try:
            yield
        except CardProblem as problem:
            self.errors.append(self.deck.error(entry, problem.field, str(problem)))
        except BEYOND_NUMBERS:
            self.errors.append(self.deck.error(entry, None, *BEYOND))
        finally:
            self.under_way = before

    def raise_errors(self) -> None:
        if self.errors:
            raise DeckErrors(self.errors)

    def own_backbones(self) -> dict[str, Any]:
        """Backbones of the hinge that is being built, by the fields that name their curves."""
        return self.backbones[self.under_way]

    def fail(self, message: str, field: str | None = None) -> CardProblem:
        """The exception for a card that cannot be built: `raise scene.fail(...)`."""
        return CardProblem(message, field)

    def refuse_stepwise(self, module: ModuleType, field: str | None = None) -> None:
        """A law that is computed in whole steps has no order in a method that takes steps in
        stages.
        """
        method = self.deck.control.integrator
        if not getattr(module, "STEPWISE", False):
            return
        law, others = module.__name__.rpartition(".")[2], getattr(module, "IMPLICIT", ())
        self.stepwise.append(law)
        if method not in ("rattle", *CHOSEN, *others):
            message = (
                f"'{law}' is computed in whole steps, integrator {method} needs rates at any time"
            )
            known = " or ".join(["rattle", *others])
            raise self.fail(f"{message}; set integrator: {known}", field)

    def joint_entry(self, name: str) -> Entry:
        """Entry of a joint that another card names, of whichever family."""
        known = (self.deck.entries[n] for n, family in families().items() if family.has_rows)
        return next(entries[name] for entries in known if name in entries)

    def refuse_joint(self, name: str, motions: tuple[str, ...], field: str) -> None:
        """A named joint without any of some motions: an `angle`, a `travel`, rotations of a `ball`.

        FREE of the file of a joint lists the free motions.
        """
        entry = self.joint_entry(name)
        if set(getattr(import_module(entry.module_name), "FREE", ())) & set(motions):
            if getattr(entry.card, "can_release", False):
                message = f"'{name}' separates when it fails, and this would still act"
                raise self.fail(f"{message}; give it after_failure: loose", field)
            return
        known = {
            word: getattr(import_module(law_class(family.folder, word).__module__), "FREE", ())
            for family in families().values()
            if family.has_rows
            for word in types_in(family.folder)
        }
        fit = [word for word in known if set(known[word]) & set(motions)]
        reason = f"'{name}' is of type {entry.type} and has no {' or '.join(motions)}"
        raise self.fail(f"{reason}; name one of type {', '.join(fit)}", field)

    def warn(self, message: str) -> None:
        if message not in self.warnings:
            self.warnings.append(message)

    def node(self, body: str) -> int:
        """Index of a body or of a node of a part that may move by itself."""
        i = self._index[body]
        if i in self.welded:
            whole = self.names[self.welded[i]]
            raise self.fail(f"'{body}' is welded to '{whole}' and is no body; name '{whole}'")
        return i

    def placed_nodes(self) -> dict[str, np.ndarray]:
        """Positions and configurations at the start, as the node table names them."""
        return {"r": self.r, "A": self.A}

    def law(self, keyword: str, name: str) -> tuple[ModuleType, Any]:
        """Module and card of an entry that another card names."""
        entry = self.deck.entries[keyword][name]
        return import_module(entry.module_name), entry.card

    def built(self, card: object) -> Any:
        """Columns that a law within a card builds."""
        return import_module(type(card).__module__).build(card, self)

    def mesh(self, card: Meshed) -> Mesh:
        """The mesh of a part, refused where its elements do not hang together."""
        from crashsolve.model.checks.mesh_check import faults

        mesh: Mesh = self.built(card.mesh)
        # that of a shared mesh has been looked at as a whole
        if mesh.own is None and (wrong := faults(mesh)):
            raise self.fail(wrong, "mesh")
        return mesh

    def meshed(self, part: str) -> DiscretisedShell:
        """A part with points in place."""
        return self._meshed[part]

    def on_mesh_of(self, meshed: PartOfScene) -> list[DiscretisedShell]:
        """Parts in place with points of the same mesh, in the order of the deck."""
        return [part for part in self._with_points().values() if part.first == meshed.first]

    def _with_points(self) -> dict[str, DiscretisedShell]:
        """Parts in place with points, type by type as the model has them."""
        entries = [self.deck.entries["parts"][name] for name in self._meshed]
        types = list(dict.fromkeys(entry.type for entry in entries))
        ordered = sorted(entries, key=lambda entry: types.index(entry.type))
        return {entry.name: self._meshed[entry.name] for entry in ordered}

    def has_points(self, part: str) -> bool:
        """Whether the nodes of a part are points."""
        return part in self._meshed

    def skin(self, part: str, field: str) -> tuple[DiscretisedShell, int, int]:
        """A part with points in place, its first corner, and the first point of its mesh."""
        corner = 0
        for name, meshed in self._with_points().items():
            if name == part:
                return meshed, corner, meshed.first
            corner += meshed.corners().size
        raise self.fail(f"part '{part}' has no surface; name a shell", field)

    def first_number(self, part: str) -> int:
        """First number of a part with points in the blocks."""
        parts = self._with_points()
        return sum(parts[name].size for name in takewhile(lambda name: name != part, parts))

    @property
    def threads(self) -> int:
        """Threads that share the steps of the run; plain Python has one."""
        return 1 if runs_plain() else self.deck.threads

    def can_fail(self, part: str) -> bool:
        """Whether elements of a part may be deleted."""
        return part in self._meshed and self.meshed(part).can_fail

    def faces(self, part: str, field: str) -> tuple[int, int, int]:
        """First corner of a part with points, its quadrilaterals and its triangles."""
        meshed, corner, _ = self.skin(part, field)
        return corner, meshed.quad_count, len(meshed.area) - meshed.quad_count

    def curve(self, name: str) -> int:
        return self.curves[name]

    def unit(self, direction: ArrayLike, field: str) -> Vector:
        """Unit vector; a zero direction is refused at `field`."""
        x = np.asarray(direction, float)
        # the squares that np.linalg.norm adds overflow, or vanish
        length = hypot(*x.tolist())
        if not 0.0 < length < inf:
            raise self.fail("a direction needs a length; give for instance [0, 0, 1]", field)
        return x / length

    def from_mass_centre(self, node: int, point: ArrayLike) -> Vector:
        """Point of the body's card frame, measured from the mass centre, body axes."""
        return np.asarray(point, float) - self.offset[node]

    def matrix(self, node: int) -> np.ndarray:
        return self.A[node].reshape(3, 3)

    def world_point(self, node: int, point: ArrayLike) -> Vector:
        """Start position of a point of the body's card frame."""
        return self.r[node] + self.matrix(node) @ self.from_mass_centre(node, point)

    def to_body(self, node: int, x: Vector) -> Vector:
        """World point at the start, from the mass centre in body axes."""
        return self.matrix(node).T @ (x - self.r[node])

    def rotation_to_body(self, node: int, u: Vector) -> Vector:
        return self.matrix(node).T @ u

    def attachments(self, card: Attached) -> Columns:
        """Ends of a spring: `a`, `b`, `at_a`, `at_b` in each body's own axes."""
        if card.a == card.b:
            raise self.fail(f"joins '{card.a}' with itself; a and b must differ", "b")
        a, b = self.node(card.a), self.node(card.b)
        return {
            "node_a": a,
            "node_b": b,
            "point_a": self.from_mass_centre(a, card.at_a),
            "point_b": self.from_mass_centre(b, card.at_b),
        }

    def distance(self, ends: Columns) -> float:
        """Distance between two attachments at the start [m]."""
        a, b = ends["node_a"], ends["node_b"]
        x_a = self.r[a] + self.matrix(a) @ ends["point_a"]
        x_b = self.r[b] + self.matrix(b) @ ends["point_b"]
        return float(np.linalg.norm(x_b - x_a))

    def rotation_about_axis(self, card: AboutAxis) -> Columns:
        """Rotation of b about `axis` of a, with sides that meet at the start."""
        if card.a == card.b:
            raise self.fail(f"joins '{card.a}' with itself; a and b must differ", "b")
        a, b = self.node(card.a), self.node(card.b)
        axis = self.unit(card.axis, "axis")
        side = perpendicular(axis)
        side_b = self.rotation_to_body(b, self.matrix(a) @ side)
        return {"node_a": a, "node_b": b, "axis_a": axis, "side_a": side, "side_b": side_b}

    def joint_point(self, card: Jointed) -> tuple[int, int, Vector]:
        """Both nodes and the joint's point in world components at the start."""
        if card.a == card.b:
            raise self.fail(f"joins '{card.a}' with itself; a and b must differ", "b")
        a, b = self.node(card.a), self.node(card.b)
        if card.frame == "world":
            return a, b, np.asarray(card.at, float)
        return a, b, self.world_point(self.node(card.frame), card.at)

    def joint_frame(self, card: Jointed) -> Columns:
        """Point and right-handed triad (axis, side, third) of a joint, axes of both bodies."""
        a, b, x = self.joint_point(card)
        frame = {
            "node_a": a,
            "node_b": b,
            "point_a": self.to_body(a, x),
            "point_b": self.to_body(b, x),
        }
        if not hasattr(card, "axis"):
            return frame
        axis = self.unit(card.axis, "axis")
        if card.frame != "world":
            axis = self.matrix(self.node(card.frame)) @ axis
        side = perpendicular(axis)
        for name, u in (("axis", axis), ("side", side), ("third", np.cross(axis, side))):
            frame[f"{name}_a"] = self.rotation_to_body(a, u)
            frame[f"{name}_b"] = self.rotation_to_body(b, u)
        return frame
