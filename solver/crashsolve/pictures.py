"""From bodies to pictures: blocks of surfaces, mass centres, springs, beams and contact forces."""

from typing import Any

import numpy as np

from crashsolve.deck.family import LINE, families
from crashsolve.foundation.posture import perpendicular
from crashsolve.model.model import ContactGroup, Group
from crashsolve.output import shapes
from crashsolve.output.blocks import GHOST, Block, FieldSpec
from crashsolve.system.engine import Engine

VELOCITY = FieldSpec("velocity", "m/s", 3, "node")
FORCE = FieldSpec("force", "N", 3, "node")
BODY = FieldSpec("body", "1", 1, "cell")
TENSION = FieldSpec("tension", "N", 1, "cell")
# of beams, along the axes of the element; densities are per length
BEAM = {
    "force": FieldSpec("force", "N", 3, "cell"),
    "moment_a": FieldSpec("moment_a", "N m", 3, "cell"),
    "moment_b": FieldSpec("moment_b", "N m", 3, "cell"),
    "stored": FieldSpec("elastic_energy_density", "J/m", 1, "cell"),
}
YIELDING_BEAM = {
    "plastic_work": FieldSpec("plastic_energy_density", "J/m", 1, "cell"),
    "plastic_strain": FieldSpec("plastic_strain", "1", 1, "cell"),
}
PER_LENGTH = ("stored", "plastic_work")
# value of GHOST for cells that are not drawn
DELETED = 32
# planes are endless: draw them this much larger than the model
PLANE_SIZE = 2.0
# contact points drawn per element where pairs come and go; balls in a heap have three each
TOUCHES = 3

# node, points from the mass centre in body axes, triangles
Piece = tuple[int, np.ndarray, np.ndarray]


class Pictures:
    """Blocks of a scene, and the fields they carry at a state."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        # points are drawn where they were at the start, and carry their displacement
        self._r0 = engine.state.nodes["r"][: len(engine.model.bodies)].copy()
        self._A0 = engine.state.nodes["A"].copy()
        self._skin = self._surfaces()
        self._lines = self._line_groups()
        self._beams = [
            g for g in engine.model.groups if g.keyword == "parts" and hasattr(g.module, "force")
        ]
        self._shells = [
            (name, row, g.module)
            for g in engine.model.element_groups()
            for name, row in zip(g.names, g.parameters, strict=True)
        ]
        self._pairs = [(g, n) for g in engine.model.contact_groups if (n := _places(g))]
        self.blocks = self._blocks()

    def _surfaces(self) -> dict[str, list[Piece]]:
        """Every drawn shape, those fixed to the ground apart from those that move."""
        pieces: dict[str, list[Piece]] = {"bodies": [], "ground": []}
        middle = self._r0[1:].mean(axis=0) if len(self._r0) > 1 else np.zeros(3)
        drawn = [s for s in self.engine.model.surfaces.values() if s.entry.type in DRAW]
        for surface in drawn:
            for element in surface.elements:
                draw, node = DRAW[surface.entry.type], int(element["node"])
                points, triangles = draw(element, middle, self.engine.model.size)
                pieces["bodies" if node else "ground"].append((node, points, triangles))
        return {name: found for name, found in pieces.items() if found}

    def _line_groups(self) -> dict[str, list[Group]]:
        """Groups that are lines from point to point, by the section of their family."""
        found: dict[str, list[Group]] = {}
        for g in self.engine.model.groups:
            family = families().get(g.keyword)
            if (
                family is not None
                and family.picture == LINE
                and {"point_a", "point_b"} <= set(g.parameters.dtype.names or ())
                and "force" in (g.output.dtype.names or ())
                and g.output["force"].ndim == 1
            ):
                found.setdefault(g.keyword, []).append(g)
        return found

    def _blocks(self) -> tuple[Block, ...]:
        blocks = []
        n = len(self._r0) - 1
        if n:
            vertices = np.arange(n)[:, None]
            points = self._r0[1:]
            blocks.append(Block("mass_centres", points, (("vertex", vertices),), (VELOCITY,)))
        for name, pieces in self._skin.items():
            points, cells = self._skin_points(pieces), _cells(pieces)
            blocks.append(Block(name, points, cells, (VELOCITY, BODY)))
        for section, groups in self._lines.items():
            points = self._line_points(groups)
            lines = np.arange(len(points)).reshape(-1, 2)
            blocks.append(Block(section, points, (("line", lines),), (TENSION,)))
        if self._beams:
            ends = self._beam_ends()
            lines = np.arange(len(ends)).reshape(-1, 2)
            specs = (VELOCITY, *self._beam_specs().values())
            blocks.append(Block("beams", self._r0[ends], (("line", lines),), specs))
        for name, row, module in self._shells:
            specs = tuple(FieldSpec(n, unit, k, "cell") for n, (unit, k) in module.FIELDS.items())
            laid = self._laid(name)
            specs += (FieldSpec(GHOST, "1", 1, "cell"),) * laid.can_fail
            n, points = laid.quad_count, self._points_of(row)["r"].copy()
            both = (("quad", laid.mesh.quads[:n]), ("triangle", laid.mesh.quads[n:, :3]))
            cells = tuple(own for own in both if len(own[1]))
            blocks.append(Block(f"part_{name}", points, cells, (VELOCITY, *specs)))
        if self._pairs:
            count = sum(places for _, places in self._pairs)
            vertices = np.arange(count)[:, None]
            blocks.append(
                Block("contacts", np.zeros((count, 3)), (("vertex", vertices),), (FORCE,))
            )
        return tuple(blocks)

    def fields(self) -> dict[str, dict[str, np.ndarray]]:
        """Displacements and fields of all blocks at the present sample."""
        nodes = self.engine.nodes[: len(self._r0)]
        fields: dict[str, dict[str, np.ndarray]] = {}
        if len(self._r0) > 1:
            moved = nodes["r"][1:] - self._r0[1:]
            fields["mass_centres"] = {"displacement": moved, "velocity": nodes["v"][1:]}
        for name, pieces in self._skin.items():
            fields[name] = self._skin_fields(pieces)
        for section, groups in self._lines.items():
            tension = np.concatenate([g.output["force"] for g in groups])
            block = next(b for b in self.blocks if b.name == section)
            moved = self._line_points(groups) - block.points
            fields[section] = {"displacement": moved, "tension": tension}
        if self._beams:
            fields["beams"] = self._beam_fields()
        for name, row, _ in self._shells:
            block = next(b for b in self.blocks if b.name == f"part_{name}")
            points = self._points_of(row)
            moved = np.empty(block.points.shape, np.float32)
            np.subtract(points["r"], block.points, out=moved, casting="same_kind")
            motion = {"displacement": moved, "velocity": points["v"].astype(np.float32)}
            found = self._laid(name).all_fields(self.engine.state.blocks, row)
            fields[block.name] = motion | found
            if self._laid(name).can_fail:
                fields[block.name][GHOST] = DELETED * (found["thickness"] == 0.0)
        if self._pairs:
            fields["contacts"] = self._contact_fields()
        return fields

    def _laid(self, name: str) -> Any:
        """A part with points as it was laid."""
        assert self.engine.model.elements is not None
        return self.engine.model.elements.parts[name]

    def _points_of(self, row: Any) -> np.ndarray:
        """Points of a part."""
        first = int(row["first_point"])
        return self.engine.state.points[first : first + int(row["point_count"])]

    def _skin_points(self, pieces: list[Piece]) -> np.ndarray:
        return np.concatenate([self._r0[n] + p @ self._A0[n].reshape(3, 3).T for n, p, _ in pieces])

    def _skin_fields(self, pieces: list[Piece]) -> dict[str, np.ndarray]:
        nodes = self.engine.nodes
        displacement, velocity, body = [], [], []
        for n, points, triangles in pieces:
            turned = points @ nodes["A"][n].reshape(3, 3).T
            old = self._r0[n] + points @ self._A0[n].reshape(3, 3).T
            displacement.append(nodes["r"][n] + turned - old)
            velocity.append(nodes["v"][n] + np.cross(nodes["w"][n], turned))
            body.append(np.full(len(triangles), float(n)))
        return {
            "displacement": np.concatenate(displacement),
            "velocity": np.concatenate(velocity),
            "body": np.concatenate(body),
        }

    def _line_points(self, groups: list[Group]) -> np.ndarray:
        """Both ends of every entry, one after the other."""
        nodes, ends = self.engine.nodes, []
        for g in groups:
            both = []
            for side in ("a", "b"):
                body = nodes[g.parameters[f"node_{side}"]]
                A = body["A"].reshape(-1, 3, 3)
                both.append(body["r"] + np.einsum("nij,nj->ni", A, g.parameters[f"point_{side}"]))
            ends.append(np.stack(both, axis=1).reshape(-1, 3))
        return np.concatenate(ends)

    def _beam_ends(self) -> np.ndarray:
        """Nodes at both ends of every element, one after the other."""
        pairs = [np.stack([g.parameters["node_a"], g.parameters["node_b"]], 1) for g in self._beams]
        return np.concatenate(pairs).ravel()

    def _beam_specs(self) -> dict[str, FieldSpec]:
        """Fields of elements by the output that they show; of yielding only where there is any."""
        yields = any("plastic_work" in (g.output.dtype.names or ()) for g in self._beams)
        return BEAM | (YIELDING_BEAM if yields else {})

    def _beam_fields(self) -> dict[str, np.ndarray]:
        """What the elements of beams bear and store; what is elastic has not yielded."""
        nodes, ends = self.engine.nodes, self._beam_ends()
        fields = {"displacement": nodes["r"][ends] - self._r0[ends], "velocity": nodes["v"][ends]}
        for name, spec in self._beam_specs().items():
            parts = []
            for g in self._beams:
                known = name in (g.output.dtype.names or ())
                values = g.output[name] if known else np.zeros(len(g.names))
                parts.append(values / g.parameters["length"] if name in PER_LENGTH else values)
            fields[spec.name] = np.concatenate(parts)
        return fields

    def _contact_fields(self) -> dict[str, np.ndarray]:
        """Contact points with their forces; a pair that is apart rests on its body."""
        moved, forces = zip(*(self._touches(g, n) for g, n in self._pairs), strict=True)
        return {"displacement": np.concatenate(moved), "force": np.concatenate(forces)}

    def _touches(self, g: ContactGroup, places: int) -> tuple[np.ndarray, np.ndarray]:
        """Points and forces of a group; of pairs that come and go, the largest forces."""
        strength = np.linalg.norm(g.output["force"], axis=1)
        shown = np.arange(len(strength))
        if g.search is not None:
            shown = np.sort(np.argsort(-strength, kind="stable")[:places])
        home = self.engine.nodes["r"][g.elements_a["node"][g.parameters["a"][shown]]]
        point = np.where(strength[shown, None] > 0.0, g.output["point"][shown], home)
        # what is left over waits at the first body, without a force
        rest = places - len(shown)
        point = np.concatenate([point, np.tile(self.engine.nodes["r"][1], (rest, 1))])
        return point, np.concatenate([g.output["force"][shown], np.zeros((rest, 3))])


def _places(g: ContactGroup) -> int:
    """Contact points drawn for a group: all its pairs, or, where these come and go, enough."""
    if g.search is None:
        return len(g.parameters)
    return TOUCHES * (len(g.elements_a) + len(g.elements_b))


def _cells(pieces: list[Piece]) -> tuple[tuple[str, np.ndarray], ...]:
    """Triangles of all pieces, their points counted through."""
    first, cells = 0, []
    for _, points, triangles in pieces:
        cells.append(np.asarray(triangles) + first)
        first += len(points)
    return (("triangle", np.concatenate(cells)),)


def _placed(element: Any, surface: shapes.Surface) -> shapes.Surface:
    """Shape axes to body axes, at the shape's centre."""
    points, triangles = surface
    axes = np.asarray(element.get("axes", np.eye(3))).reshape(3, 3)
    return np.asarray(element["point"]) + points @ axes.T, triangles


def _plane(element: Any, middle: np.ndarray, size: float) -> shapes.Surface:
    """A square of the plane below the model's middle, or about its own point on a body."""
    normal, point = np.asarray(element["normal"]), np.asarray(element["point"])
    if element["node"] == 0:
        point = middle - normal * float(normal @ (middle - point))
    side = perpendicular(normal)
    axes = np.column_stack([side, np.cross(normal, side), normal])
    return _placed({"point": point, "axes": axes}, shapes.plane(PLANE_SIZE * size))


DRAW: dict[str, Any] = {
    "sphere": lambda e, *_: _placed(e, shapes.sphere(e["radius"])),
    "ellipsoid": lambda e, *_: _placed(e, shapes.ellipsoid(*e["semi"])),
    "cylinder": lambda e, *_: _placed(e, shapes.cylinder(e["radius"], e["half_length"])),
    "box": lambda e, *_: _placed(e, shapes.box(*e["half"])),
    "mesh": lambda e, *_: _placed(e, (e["points"], e["faces"])),
    "plane": _plane,
}
