"""From bodies to pictures: blocks of surfaces, mass centres, springs and contact forces."""

from typing import Any

import numpy as np

from crashsolve.output import shapes
from crashsolve.output.blocks import Block, FieldSpec
from crashsolve.system.engine import Engine

VELOCITY = FieldSpec("velocity", "m/s", 3, "node")
FORCE = FieldSpec("force", "N", 3, "node")
BODY = FieldSpec("body", "1", 1, "cell")
TENSION = FieldSpec("tension", "N", 1, "cell")
# planes are endless: draw them this much larger than the model
PLANE_SIZE = 3.0


class Pictures:
    """Blocks of a scene, and the fields they carry at a state."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        # points are drawn where they were at the start, and carry their displacement
        self._r0 = engine.state.nodes["r"].copy()
        self._A0 = engine.state.nodes["A"].copy()
        self._skin = self._surfaces()
        self._lines = self._springs()
        # the pairs of a searched group come and go: a block of fixed size cannot show them
        fixed = [g for g in engine.model.contact_groups if g.search is None]
        self._pairs = [g for g in fixed if len(g.parameters)]
        self.blocks = self._blocks()

    def _surfaces(self) -> list[tuple[int, np.ndarray, np.ndarray]]:
        """Node, points from the mass centre in body axes and triangles of every drawn shape."""
        skin = []
        drawn = [s for s in self.engine.model.surfaces.values() if s.entry.type in DRAW]
        for surface in drawn:
            for element in surface.elements:
                draw = DRAW[surface.entry.type]
                points, triangles = draw(element, surface.entry.card, self.engine.model.size)
                skin.append((int(element["node"]), points, triangles))
        return skin

    def _springs(self) -> list[tuple[Any, Any]]:
        """Groups of springs that are lines from point to point."""
        springs = [g for g in self.engine.model.groups if g.keyword == "springs"]
        return [
            (g, g.output["force"] if "force" in (g.output.dtype.names or ()) else None)
            for g in springs
            if {"point_a", "point_b"} <= set(g.parameters.dtype.names or ())
            and "force" in (g.output.dtype.names or ())
            and g.output["force"].ndim == 1
        ]

    def _blocks(self) -> tuple[Block, ...]:
        blocks = []
        n = len(self._r0) - 1
        if n:
            vertices = np.arange(n)[:, None]
            points = self._r0[1:]
            blocks.append(Block("mass_centres", points, (("vertex", vertices),), (VELOCITY,)))
        if self._skin:
            blocks.append(
                Block("bodies", self._skin_points(), self._skin_cells(), (VELOCITY, BODY))
            )
        if self._lines:
            points = self._line_points()
            lines = np.arange(len(points)).reshape(-1, 2)
            blocks.append(Block("springs", points, (("line", lines),), (TENSION,)))
        if self._pairs:
            count = sum(len(g.parameters) for g in self._pairs)
            vertices = np.arange(count)[:, None]
            blocks.append(
                Block("contacts", np.zeros((count, 3)), (("vertex", vertices),), (FORCE,))
            )
        return tuple(blocks)

    def fields(self) -> dict[str, dict[str, np.ndarray]]:
        """Displacements and fields of all blocks at the present sample."""
        nodes = self.engine.nodes
        fields: dict[str, dict[str, np.ndarray]] = {}
        if len(self._r0) > 1:
            moved = nodes["r"][1:] - self._r0[1:]
            fields["mass_centres"] = {"displacement": moved, "velocity": nodes["v"][1:]}
        if self._skin:
            fields["bodies"] = self._skin_fields()
        if self._lines:
            tension = np.concatenate([g.output["force"] for g, _ in self._lines])
            block = next(b for b in self.blocks if b.name == "springs")
            moved = self._line_points() - block.points
            fields["springs"] = {"displacement": moved, "tension": tension}
        if self._pairs:
            fields["contacts"] = self._contact_fields()
        return fields

    def _skin_points(self) -> np.ndarray:
        return np.concatenate(
            [self._r0[n] + p @ self._A0[n].reshape(3, 3).T for n, p, _ in self._skin]
        )

    def _skin_cells(self) -> tuple[tuple[str, np.ndarray], ...]:
        first, cells = 0, []
        for _, points, triangles in self._skin:
            cells.append(np.asarray(triangles) + first)
            first += len(points)
        return (("triangle", np.concatenate(cells)),)

    def _skin_fields(self) -> dict[str, np.ndarray]:
        nodes = self.engine.nodes
        displacement, velocity, body = [], [], []
        for n, points, triangles in self._skin:
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

    def _line_points(self) -> np.ndarray:
        """Both ends of every spring, one after the other."""
        nodes, ends = self.engine.nodes, []
        for g, _ in self._lines:
            both = []
            for side in ("a", "b"):
                body = nodes[g.parameters[f"node_{side}"]]
                A = body["A"].reshape(-1, 3, 3)
                both.append(body["r"] + np.einsum("nij,nj->ni", A, g.parameters[f"point_{side}"]))
            ends.append(np.stack(both, axis=1).reshape(-1, 3))
        return np.concatenate(ends)

    def _contact_fields(self) -> dict[str, np.ndarray]:
        """Contact points with their forces; a pair that is apart rests on its body."""
        nodes, places, forces = self.engine.nodes, [], []
        for g in self._pairs:
            force = g.output["force"]
            home = nodes["r"][g.elements_a["node"][g.parameters["a"]]]
            touching = np.any(force != 0.0, axis=1)[:, None]
            places.append(np.where(touching, g.output["point"], home))
            forces.append(force)
        return {"displacement": np.concatenate(places), "force": np.concatenate(forces)}


def _placed(element: Any, surface: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Shape axes to body axes, at the shape's centre."""
    points, triangles = surface
    axes = np.asarray(element.get("axes", np.eye(3))).reshape(3, 3)
    return np.asarray(element["point"]) + points @ axes.T, triangles


def _plane(element: Any, card: Any, size: float) -> tuple[np.ndarray, np.ndarray]:
    from crashsolve.foundation.posture import perpendicular

    normal = np.asarray(element["normal"])
    side = perpendicular(normal)
    axes = np.column_stack([side, np.cross(normal, side), normal])
    return _placed({"point": element["point"], "axes": axes}, shapes.plane(PLANE_SIZE * size))


DRAW: dict[str, Any] = {
    "sphere": lambda e, card, size: _placed(e, shapes.sphere(e["radius"])),
    "ellipsoid": lambda e, card, size: _placed(e, shapes.ellipsoid(*e["semi"])),
    "cylinder": lambda e, card, size: _placed(e, shapes.cylinder(e["radius"], e["half_length"])),
    "box": lambda e, card, size: _placed(e, shapes.box(*e["half"])),
    "plane": _plane,
}
