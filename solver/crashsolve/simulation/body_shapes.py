"""What bodies look like: pieces in body axes, of their contact surfaces, primitives or joints.

A body is drawn by its contact surfaces and by its `primitive` where that is seen beyond them;
besides by lengths of sections, which structures give their bodies. One without any of them is
drawn by lines from its mass centre to where joints, springs and contact points act on it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.family import LINE, families
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.reading.items import Entry
from crashsolve.foundation.orientation import perpendicular
from crashsolve.model.model import Group, Model
from crashsolve.output import shapes

if TYPE_CHECKING:
    from collections.abc import Callable

    from crashsolve.bodies.rigid import Primitive
    from crashsolve.deck.building import Columns

# node, points from the mass centre in body axes, cells
Piece = tuple[int, np.ndarray, np.ndarray]

# a plane is infinite: it is drawn so far beyond the model, in widths of it
PLANE_MARGIN = 0.15
# points of a body to which lines are drawn, at most
MAX_LINES = 100
# radius of a rod over its length
SLENDER = 0.01
# [of the size of a body] a primitive that reaches beyond its surfaces by less is one with them
COVERED_SHARE = 0.01


def surfaces(model: Model) -> list[Piece]:
    """Contact surfaces with a shape of their own; planes are cut to fit by `planes`.

    Not those that structures give their members: these are drawn by their sections or elements.
    """
    return [
        (int(element["node"]), *DRAW[surface.entry.type](element))
        for surface in model.surfaces.values()
        if surface.entry.type in DRAW and not surface.entry.is_made
        for element in surface.elements
    ]


def primitives(model: Model, deck: Deck, shaped: list[Piece]) -> list[Piece]:
    """Primitives of bodies, except those inside another drawing of the body."""
    pieces: list[Piece] = []
    for name, entry in deck.entries.get("bodies", {}).items():
        node, solid = model.bodies.index(name), getattr(entry.card, "primitive", None)
        if solid is None:
            continue
        piece = (node, *_primitive(solid))
        own = [points for n, points, _ in shaped if n == node]
        if not own or not _within(piece[1], np.concatenate(own)):
            pieces.append(piece)
    return pieces


def _primitive(solid: Primitive) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of a primitive."""
    length, radius = solid.length or 0.0, solid.radius or 0.0
    if solid.shape == "box":
        return shapes.box(*(0.5 * np.asarray(solid.size)))
    if solid.shape == "sphere":
        return shapes.sphere(radius)
    radius = radius if solid.shape == "cylinder" else SLENDER * length
    return shapes.cylinder(radius, 0.5 * length)


def _within(points: np.ndarray, others: np.ndarray) -> bool:
    """Whether points reach no further along any axis than others do."""
    slack = COVERED_SHARE * float(np.ptp(others, axis=0).max())
    low, high = others.min(axis=0) - slack, others.max(axis=0) + slack
    return bool(np.all(points >= low) and np.all(points <= high))


def bars(model: Model, deck: Deck) -> list[Piece]:
    """Lengths of sections that bodies are drawn by."""
    pieces: list[Piece] = []
    for name, entry in deck.entries.get("bodies", {}).items():
        for bar in entry.card.drawn:
            ends = np.array([bar.from_, bar.to]) - entry.card.mass_centre
            along = ends[1] - ends[0]
            z = np.cross(along, bar.side)
            axes = np.column_stack([np.cross(z, along), z])
            axes /= np.linalg.norm(axes, axis=0)
            edge = outline(deck.entries["sections"][bar.section])
            pieces.append((model.bodies.index(name), *shapes.prism(edge, ends, axes)))
    return pieces


def outline(entry: Entry) -> np.ndarray:
    """Outer edge (n, 2) of a section; a rectangle of the same radii of gyration without one."""
    law = import_module(entry.module_name)
    if hasattr(law, "outline"):
        points: np.ndarray = law.outline(entry.card)
        return points
    # neither depends on Poisson's ratio
    numbers = law.build(entry.card, 0.0)
    I_y, I_z = numbers["second"]
    sides = np.sqrt(12.0 * np.array([I_z, I_y]) / numbers["area"])
    return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * sides / 2.0


def lines(model: Model, deck: Deck, shaped: set[int]) -> list[Piece]:
    """Lines from the mass centre of each body without a shape to where something acts on it."""
    ends: dict[int, list[np.ndarray]] = {}
    for group in model.groups:
        for node, point in _acting_points(group):
            ends.setdefault(node, []).append(point)
    for surface in model.surfaces.values():
        if surface.entry.type == "point_set":
            for element in surface.elements:
                ends.setdefault(int(element["node"]), []).append(np.asarray(element["point"]))
    pieces: list[Piece] = []
    for name in deck.entries.get("bodies", {}):
        node = model.bodies.index(name)
        reached = [point for point in ends.get(node, []) if np.any(point)][:MAX_LINES]
        if reached and node not in shaped:
            points = np.array([np.zeros(3), *reached])
            far = np.arange(1, len(points))
            pieces.append((node, points, np.column_stack([np.zeros_like(far), far])))
    return pieces


def _acting_points(group: Group) -> list[tuple[int, np.ndarray]]:
    """Node and point from its mass centre, of both sides of joints and lines."""
    family = families()[group.keyword]
    if not family.has_rows and family.picture != LINE:
        return []
    names, acting_points = group.parameters.dtype.names or (), []
    if group.joins_several and "count" in names:
        for row in group.parameters:
            points = row["point"].reshape(-1, 3)[: row["count"]]
            acting_points += list(zip(map(int, row["node"]), points, strict=False))
    for side in "ab":
        if {f"node_{side}", f"point_{side}"} <= set(names):
            for row in group.parameters:
                acting_points.append((int(row[f"node_{side}"]), np.array(row[f"point_{side}"])))
    return acting_points


def planes(model: Model, pieces: list[Piece], nodes: np.ndarray, others: np.ndarray) -> list[Piece]:
    """Planes, cut to the extent of near objects at the start: their own body, or all others.

    `others` are points (n, 3) of all that is drawn besides bodies, `nodes` those at the start.
    """
    cut_planes: list[Piece] = []
    for surface in model.surfaces.values():
        if surface.entry.type != "plane":
            continue
        for element in surface.elements:
            node = int(element["node"])
            own = [points for n, points, _ in pieces if n == node and node]
            if own:
                near = np.concatenate(own)
            else:
                r, A = nodes["r"][node], nodes["A"][node].reshape(3, 3)
                near = (np.concatenate([in_world(pieces, nodes), others]) - r) @ A
            cut_planes.append((node, *_cut_plane(element, near, model.size)))
    return cut_planes


def in_world(pieces: list[Piece], nodes: np.ndarray) -> np.ndarray:
    """Points (n, 3) of all pieces."""
    placed = [nodes["r"][n] + p @ nodes["A"][n].reshape(3, 3).T for n, p, _ in pieces]
    return np.concatenate([np.empty((0, 3)), *placed])


def _cut_plane(element: Columns, near: np.ndarray, size: float) -> shapes.Surface:
    """The rectangle of a plane that lies below some points, with a margin."""
    normal, point = np.asarray(element["normal"]), np.asarray(element["point"])
    side = perpendicular(normal)
    axes = np.column_stack([side, np.cross(normal, side)])
    flat = (near if len(near) else point[None]) @ axes
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = PLANE_MARGIN * max(np.max(high - low), 0.0) or 0.5 * size
    low, high = low - margin, high + margin
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return corners @ axes.T + normal * float(normal @ point), np.array([[0, 1, 2], [0, 2, 3]])


def _placed(element: Columns, surface: shapes.Surface) -> shapes.Surface:
    """Shape axes to body axes, at the shape's centre."""
    points, triangles = surface
    axes = np.asarray(element.get("axes", np.eye(3))).reshape(3, 3)
    return np.asarray(element["point"]) + points @ axes.T, triangles


DRAW: dict[str, Callable[[Columns], tuple[np.ndarray, np.ndarray]]] = {
    "sphere": lambda e: _placed(e, shapes.sphere(e["radius"])),
    "ellipsoid": lambda e: _placed(e, shapes.ellipsoid(*e["semi"])),
    "cylinder": lambda e: _placed(e, shapes.cylinder(e["radius"], e["half_length"])),
    "box": lambda e: _placed(e, shapes.box(*e["half"])),
    "mesh": lambda e: _placed(e, (e["points"], e["faces"])),
}
