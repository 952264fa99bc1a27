"""From bodies to pictures: blocks of surfaces, mass centres, springs, beams and contact forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.family import ELEMENTS, LINE, MARK, ROUTE, families
from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.orientation import matrix, rotated_by
from crashsolve.model.model import Group
from crashsolve.output.blocks import GHOST, Block, FieldSpec
from crashsolve.output.files import Json
from crashsolve.simulation import body_shapes
from crashsolve.simulation.body_shapes import Piece, outline
from crashsolve.simulation.contact_points import ContactPoints, acts
from crashsolve.simulation.skins import Skin, motion_of
from crashsolve.system.engine import Engine

if TYPE_CHECKING:
    from crashsolve.deck.reading.items import Entry
    from crashsolve.elements.shells.layout import DiscretisedShell
    from crashsolve.simulation.hinge_marks import HingeMarks

VELOCITY = FieldSpec("velocity", "m/s", 3, "node")
FORCE = FieldSpec("force", "N", 3, "node")
BODY = FieldSpec("body", "1", 1, "cell")
TENSION = FieldSpec("tension", "N", 1, "cell")
ROTATION = FieldSpec("rotation", "rad", 3, "node")
PART = FieldSpec("part", "1", 1, "cell")
SECTION = FieldSpec("section", "1", 1, "cell")
SIDE = FieldSpec("side", "1", 3, "cell")
RADIUS = FieldSpec("radius", "m", 1, "node")
CONTACT = FieldSpec("contact", "1", 1, "cell")
HIDDEN = FieldSpec(GHOST, "1", 1, "cell")
# components along the axes of an element are no vector in space: one field each
AXES = "xyz"
TENSOR = ("xx", "yy", "xy")
BEAM_AXES = {"force": "N", "moment_a": "N m", "moment_b": "N m"}
# of beams; densities are per length
BEAM = {
    "stored": FieldSpec("elastic_energy_density", "J/m", 1, "cell"),
}
YIELDING_BEAM = {
    "plastic_work": FieldSpec("plastic_energy_density", "J/m", 1, "cell"),
    "plastic_strain": FieldSpec("plastic_strain", "1", 1, "cell"),
}
PER_LENGTH = ("stored", "plastic_work")
# value of GHOST for cells that are not drawn
DELETED = 32


class Pictures:
    """Blocks of a scene, and the fields they carry at a state."""

    def __init__(self, engine: Engine, deck: Deck) -> None:
        self.engine, self.deck = engine, deck
        # points are drawn where they were at the start, and carry their displacement
        self._r0 = engine.state.nodes["r"][: len(engine.model.bodies)].copy()
        self._A0 = engine.state.nodes["A"].copy()
        self._q0 = engine.state.nodes["q"].copy()
        self._lines = self._line_groups()
        self._beams = [
            g for g in engine.model.force_groups() if families()[g.keyword].picture == ELEMENTS
        ]
        self._shells = [
            (name, row, g.module)
            for g in engine.model.element_groups()
            for name, row in zip(g.names, g.parameters, strict=True)
        ]
        self._contact_points = ContactPoints(engine)
        self._marks = self._hinge_marks()
        start = engine.state.nodes
        self._skins = {name: Skin(pieces, start) for name, pieces in self._pieces().items()}
        self.blocks = self._blocks()

    def description(self) -> Json:
        """Names of the numbers in the blocks, sections of beams (y, z) [m], vertical direction."""
        entries = self.deck.entries
        weights = [g.parameters for g in self.engine.model.groups if g.word == "loads_gravity"]
        pull = sum((w["acceleration"].sum(axis=0) for w in weights), np.zeros(3))
        up = -pull / np.linalg.norm(pull) if np.any(pull) else np.array([0.0, 0.0, 1.0])
        return {
            "names": {
                "bodies": list(self.engine.model.bodies),
                "parts": list(entries.get("parts", {})),
                "contacts": list(self.engine.model.contacts),
            },
            "sections": [outline(e).tolist() for e in entries.get("sections", {}).values()],
            "up": up.tolist(),
        }

    def _pieces(self) -> dict[str, list[Piece]]:
        """Every drawn shape, those fixed to the ground apart from those that move; lines."""
        model = self.engine.model
        shapes = body_shapes.surfaces(model)
        shapes += body_shapes.primitives(model, self.deck, shapes)
        shapes += body_shapes.bars(model, self.deck)
        links = body_shapes.lines(model, self.deck, {node for node, _, _ in shapes})
        nodes = self.engine.state.nodes
        ends = self._line_points([g for some in self._lines.values() for g in some])
        others = [self._r0[1:], ends, body_shapes.in_world(links, nodes)]
        others += [self._points_of(name)["r"] for name, _, _ in self._shells]
        shapes += body_shapes.planes(model, shapes, nodes, np.concatenate(others))
        pieces = {
            "bodies": [piece for piece in shapes if piece[0]],
            "ground": [piece for piece in shapes if not piece[0]],
            "links": links,
            "roads": self._roads(nodes),
        }
        return {name: parts for name, parts in pieces.items() if parts}

    def _hinge_marks(self) -> HingeMarks | None:
        """Balls of the hinges; None of a scene without hinges."""
        model = self.engine.model
        if not any(families()[g.keyword].picture == MARK for g in model.groups):
            return None
        from crashsolve.simulation.hinge_marks import HingeMarks

        return HingeMarks(model, self.engine.state.nodes)

    def _roads(self, nodes: np.ndarray) -> list[Piece]:
        """Profiles below the tyres of a scene that has some."""
        if not any(g.keyword == "tyres" for g in self.engine.model.force_groups()):
            return []
        from crashsolve.simulation.drawn_roads import profiles

        return profiles(self.engine.model, nodes, self.deck.control.end_time)

    def _line_groups(self) -> dict[str, list[Group]]:
        """Groups that are lines from point to point, by the section of their family."""
        groups_of: dict[str, list[Group]] = {}
        for g in self.engine.model.groups:
            if (
                families()[g.keyword].picture == LINE
                and (
                    {"point_a", "point_b"} <= set(g.parameters.dtype.names or ()) or g.joins_several
                )
                and "force" in (g.output.dtype.names or ())
                and g.output["force"].ndim == 1
            ) or families()[g.keyword].picture == ROUTE:
                groups_of.setdefault(g.keyword, []).append(g)
        return groups_of

    def _blocks(self) -> tuple[Block, ...]:
        blocks = []
        n = len(self._r0) - 1
        if n:
            vertices = np.arange(n)[:, None]
            points = self._r0[1:]
            counted = ((BODY, np.arange(1.0, n + 1.0)),)
            blocks.append(
                Block("mass_centres", points, (("vertex", vertices),), (VELOCITY,), counted)
            )
        for name, skin in self._skins.items():
            counted = ((BODY, skin.bodies),)
            blocks.append(Block(name, skin.points, skin.cells, (VELOCITY,), counted))
        for section, groups in self._lines.items():
            points = self._line_points(groups)
            lines = np.arange(len(points)).reshape(-1, 2)
            blocks.append(Block(section, points, (("line", lines),), (TENSION,)))
        if self._beams:
            ends = self._beam_ends()
            lines = np.arange(len(ends)).reshape(-1, 2)
            axial = (
                FieldSpec(f"{n}_{x}", u, 1, "cell") for n, u in BEAM_AXES.items() for x in AXES
            )
            specs = (VELOCITY, ROTATION, *axial, *self._beam_specs().values())
            fixed = self._beam_fixed()
            blocks.append(Block("beams", self._r0[ends], (("line", lines),), specs, fixed))
        for name, _, module in self._shells:
            specs = _specs_of(module.FIELDS)
            meshed = self._meshed(name)
            specs += (HIDDEN,) * meshed.can_fail
            n, points = meshed.quad_count, self._points_of(name)["r"].copy()
            # of a shared mesh a picture has the part's own points alone
            quads = np.searchsorted(meshed.used, meshed.mesh.quads)
            both = (("quad", quads[:n]), ("triangle", quads[n:, :3]))
            cells = tuple(own for own in both if len(own[1]))
            blocks.append(Block(f"part_{name}", points, cells, (VELOCITY, *specs)))
        if count := self._contact_points.count:
            cells = (("vertex", np.arange(count)[:, None]),)
            specs = (FORCE, CONTACT, HIDDEN)
            blocks.append(Block("contacts", np.zeros((count, 3)), cells, specs, is_placed=True))
        return (*blocks, *(self._marks.blocks() if self._marks else ()))

    def fields(self) -> dict[str, dict[str, np.ndarray]]:
        """Displacements (points, 3) [m] and fields of all blocks at the present sample."""
        nodes = self.engine.nodes[: len(self._r0)]
        fields: dict[str, dict[str, np.ndarray]] = {}
        if len(self._r0) > 1:
            moved = nodes["r"][1:] - self._r0[1:]
            fields["mass_centres"] = {"displacement": moved, "velocity": nodes["v"][1:]}
        matrices = motion_of(self.engine.nodes)
        for name, skin in self._skins.items():
            fields[name] = skin.fields(matrices)
        for section, groups in self._lines.items():
            tension = np.concatenate([_tension(g) for g in groups])
            moved = self._line_points(groups) - self._block(section).points
            fields[section] = {"displacement": moved, "tension": tension}
        if self._beams:
            fields["beams"] = self._beam_fields()
        for name, row, _ in self._shells:
            block = self._block(f"part_{name}")
            points = self._points_of(name)
            moved = np.empty(block.points.shape, np.float32)
            np.subtract(points["r"], block.points, out=moved, casting="same_kind")
            motion = {"displacement": moved, "velocity": points["v"].astype(np.float32)}
            values = self._meshed(name).all_fields(self.engine.state.blocks, row)
            fields[block.name] = motion | _split_values(values)
            if self._meshed(name).can_fail:
                fields[block.name][GHOST] = DELETED * (values["thickness"] == 0.0)
        if self._contact_points.count:
            fields["contacts"] = self._contact_fields()
        return fields | self._marks.fields(nodes) if self._marks else fields

    def _meshed(self, name: str) -> DiscretisedShell:
        """A part with points as it was made."""
        assert self.engine.model.elements is not None
        return self.engine.model.elements.parts[name]

    def _points_of(self, name: str) -> np.ndarray:
        """Points of a part: a view, or those that it has of a shared mesh."""
        meshed, points = self._meshed(name), self.engine.state.points
        if meshed.mesh.own is None:
            return points[meshed.first : meshed.first + len(meshed.used)]
        positions: np.ndarray = points[meshed.first + meshed.used]
        return positions

    def _block(self, name: str) -> Block:
        return next(block for block in self.blocks if block.name == name)

    def _line_points(self, groups: list[Group]) -> np.ndarray:
        """Both ends of every entry, one after the other."""
        nodes, ends = self.engine.nodes, []
        for g in groups:
            if families()[g.keyword].picture == ROUTE:
                ends += _spans(g, int(self.engine.clock.current))
                continue
            if g.joins_several:
                ends += _through(g, nodes)
                continue
            both = []
            for side in ("a", "b"):
                body = g.parameters[f"node_{side}"]
                A = nodes["A"][body].reshape(-1, 3, 3)
                both.append(
                    nodes["r"][body] + np.einsum("nij,nj->ni", A, g.parameters[f"point_{side}"])
                )
            ends.append(np.stack(both, axis=1).reshape(-1, 3))
        return np.concatenate([np.empty((0, 3)), *ends])

    def _beam_ends(self) -> np.ndarray:
        """Nodes at both ends of every element, one after the other."""
        pairs = [np.stack([g.parameters["node_a"], g.parameters["node_b"]], 1) for g in self._beams]
        return np.concatenate(pairs).ravel()

    def _beam_fixed(self) -> tuple[tuple[FieldSpec, np.ndarray], ...]:
        """Part, section, y axis at the start and radius of the elements of beams."""
        parts, sections = self.deck.entries["parts"], list(self.deck.entries["sections"].items())
        outlines = [outline(entry) for _, entry in sections]
        radii = [_radius(points) for points in outlines]
        of = {n: (k, e.card) for k, (p, e) in enumerate(parts.items()) for n in _elements(e, p)}
        numbers = [of[name] for g in self._beams for name in g.names]
        names = [name for name, _ in sections]
        section = np.array([names.index(card.section) for _, card in numbers])
        side = np.concatenate([_side(g, self._A0) for g in self._beams])
        return (
            (PART, np.array([float(part) for part, _ in numbers])),
            (SECTION, section.astype(float)),
            (SIDE, side),
            (RADIUS, np.repeat(np.array(radii)[section], 2)),
        )

    def _beam_specs(self) -> dict[str, FieldSpec]:
        """Fields of elements by the output that they show; of yielding only where there is any."""
        yields = any("plastic_work" in (g.output.dtype.names or ()) for g in self._beams)
        return BEAM | (YIELDING_BEAM if yields else {})

    def _beam_fields(self) -> dict[str, np.ndarray]:
        """Forces and energies of beam elements; elastic ones have not yielded."""
        nodes, ends = self.engine.nodes, self._beam_ends()
        fields = {
            "displacement": nodes["r"][ends] - self._r0[ends],
            "velocity": nodes["v"][ends],
            "rotation": rotated_by(nodes["q"][ends], self._q0[ends]),
        }
        for name in BEAM_AXES:
            whole = np.concatenate([g.output[name] for g in self._beams])
            fields |= {f"{name}_{axis}": whole[:, k] for k, axis in enumerate(AXES)}
        for name, spec in self._beam_specs().items():
            parts = []
            for g in self._beams:
                known = name in (g.output.dtype.names or ())
                values = g.output[name] if known else np.zeros(len(g.names))
                parts.append(values / g.parameters["length"] if name in PER_LENGTH else values)
            fields[spec.name] = np.concatenate(parts)
        return fields

    def _contact_fields(self) -> dict[str, np.ndarray]:
        """Contact points with their forces; pairs that are apart are hidden."""
        points, forces, cards = self._contact_points.points()
        hidden = DELETED * ~acts(forces)
        return {"points": points, "force": forces, "contact": cards, GHOST: hidden}


def _spans(g: Group, current: int) -> list[np.ndarray]:
    """Both ends of every segment of the routes of a group, and of the parts on surfaces."""
    segments = []
    for row, route in zip(g.parameters, g.history[current], strict=True):
        n = int(row["segments"])
        leave, arrive = (route[name].reshape(-1, 3) for name in ("leave", "arrive"))
        segments.append(np.stack([leave[:n], arrive[1 : n + 1]], axis=1).reshape(-1, 3))
        segments.append(np.stack([arrive[1:n], leave[1:n]], axis=1).reshape(-1, 3))
    return segments


def _through(g: Group, nodes: np.ndarray) -> list[np.ndarray]:
    """Both ends of every span of the lines of a group, from point to point."""
    segments = []
    for row in g.parameters:
        n = int(row["count"])
        bodies, points = row["node"][:n], row["point"].reshape(-1, 3)[:n]
        A = nodes["A"][bodies].reshape(-1, 3, 3)
        x = nodes["r"][bodies] + np.einsum("nij,nj->ni", A, points)
        segments.append(np.stack([x[:-1], x[1:]], axis=1).reshape(-1, 3))
    return segments


def _tension(g: Group) -> np.ndarray:
    """Tension of every line of a group [N]."""
    force = g.output["force"]
    if g.joins_several and force.ndim == 1:
        return np.repeat(force, g.parameters["count"] - 1)
    if force.ndim == 1:
        return np.asarray(force)
    tensions = []
    for row, T in zip(g.parameters, force, strict=True):
        n = int(row["segments"])
        tensions += [T[:n], 0.5 * (T[: n - 1] + T[1:n])]
    return np.concatenate(tensions)


def _specs_of(fields: dict[str, tuple[str, int]]) -> tuple[FieldSpec, ...]:
    """Fields of the elements of a part, from their units and numbers of components."""
    return tuple(
        FieldSpec(whole, unit, 1, "cell")
        for field, (unit, components) in fields.items()
        for whole in _split(field, components)
    )


def _split(field: str, components: int) -> tuple[str, ...]:
    """Names of the components of a tensor of shells; the field itself where there is one."""
    return (field,) if components == 1 else tuple(f"{field}_{word}" for word in TENSOR)


def _split_values(fields: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Components (m, 3) of the values of a tensor; the values themselves of other fields."""
    return {
        whole: values if values.ndim == 1 else values[:, k]
        for field, values in fields.items()
        for k, whole in enumerate(_split(field, 1 if values.ndim == 1 else len(TENSOR)))
    }


def _elements(entry: Entry, part: str) -> list[str]:
    """Names of the elements of a part of beams."""
    return entry.card.element_names(part) if hasattr(entry.card, "element_names") else []


def _side(g: Group, A0: np.ndarray) -> np.ndarray:
    """Section's y axis (n, 3) of the elements of beams at the start."""
    axes = A0[g.parameters["node_a"]].reshape(-1, 3, 3)
    if "rotation" in (g.parameters.dtype.names or ()):
        axes = np.array(
            [A @ matrix(q) for A, q in zip(axes, g.parameters["rotation"], strict=True)]
        )
    return axes[:, :, 1]


def _radius(outline: np.ndarray) -> float:
    """Radius [m] of the circle with the area of an outline."""
    y, z = outline.T
    area = 0.5 * abs(np.sum(y * np.roll(z, -1) - z * np.roll(y, -1)))
    return float(np.sqrt(area / np.pi))
