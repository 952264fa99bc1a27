"""What is drawn of a run at a moment: surfaces, lines, dots and arrows with their colours.

Bodies are drawn by their surfaces, beams by their sections, springs by lines, contact forces by
arrows; deleted elements are not drawn.
"""

from collections.abc import Iterator
from fnmatch import fnmatchcase

import numpy as np

from crashpost.errors import unknown
from crashpost.renders.appearance import Appearance
from crashpost.renders.beams import Outline, outlines, prisms
from crashpost.renders.borders import are_edge_on, borders, first_edges
from crashpost.renders.camera import outermost
from crashpost.renders.cutting import clamped, half_space
from crashpost.renders.cutting import cut as cut_off
from crashpost.renders.forces import contacts_with_arrows, forces_of
from crashpost.renders.groups import groups, labels, part_of
from crashpost.renders.planes import FIXED, by_light, cut, footprints, planes
from crashpost.renders.section_lines import lines as section_lines
from crashpost.renders.section_lines import weights
from crashpost.renders.shapes import (
    COLOURS,
    GHOST,
    GREY,
    GROUND,
    LINE,
    SECTION,
    Dots,
    Drawing,
    Lines,
    Surface,
)
from crashpost.results.states import States

# lines from point to point, and how thick they are drawn
THICKNESS = {"springs": 1.6, "belts": 4.0}
WHOLE = ("bodies", "links", "mass_centres", "hinges")
UNCOLOURED = (*FIXED, "links", "mass_centres")
# a moment this near a state is that state; edges drawn between two states may be this short
LEAST_SHARE, MAX_SHRUNK = 1e-6, 0.97


class Scene:
    """Draws the states of a run by a look; raises PostError for a word that names nothing."""

    def __init__(self, states: States, appearance: Appearance) -> None:
        self.states, self.appearance = states, appearance
        names = states.names["bodies"]
        self.groups = groups(names)
        # bodies but for the nodes of parts, which are drawn by their elements
        self.owners = [part_of(name, states.names["parts"]) for name in names]
        self.own = {k for k in range(1, len(names)) if self.owners[k] is None}
        self.wholes = sorted({self.groups[k] for k in self.own})
        # in legends and colours those of many that share their first words are one
        named = [*(names[k] for k in self.wholes), *states.names["parts"]]
        self.labels = labels(named, len(COLOURS))
        self.hues = {label: k for k, label in enumerate(dict.fromkeys(self.labels))}
        self.bodies, self.parts = self._shown()
        # balls in hinges stand for a colour alone
        hidden = {"contacts"} if appearance.color.startswith("plastic_") else {"contacts", "hinges"}
        self.drawn = [name for name in states.blocks if name not in hidden]
        self.color_unit = ""
        if appearance.color:
            self._check_color()
        self.contacts = contacts_with_arrows(states, appearance)
        self.planes = planes(states)
        # points that infinite planes are drawn below; as the run cut them when absent
        self.reach: np.ndarray | None = None
        self._free_edges: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self.half = half_space(appearance.cut) if appearance.cut else None
        self.sections = [
            (f"part_{one.part}", weights(states.blocks[f"part_{one.part}"], one))
            for one in appearance.sections
            if one.part in self.parts and f"part_{one.part}" in states.blocks
        ]

    def at(self, number: float, *, is_ghost: bool = False) -> Drawing:
        """Drawing of a state."""
        drawing = Drawing()
        for name in self.drawn:
            points = self.positions(number, name)
            if name == "beams":
                self._beams(drawing, number, points)
            elif name in THICKNESS:
                self._lines(drawing, number, name, points)
            elif name == "mass_centres":
                self._dots(drawing, points)
            elif name == "links":
                self._links(drawing, points)
            else:
                self._skin(drawing, number, name, points)
        for block, at in self.sections:
            drawing.lines.append(
                Lines(section_lines(self.positions(number, block), *at), SECTION, 2.4)
            )
        if self.appearance.arrows and not is_ghost:
            drawing.arrows.append(self.forces(number))
        return cut_off(drawing, self.half) if self.half else drawing

    def ghost(self) -> Drawing:
        """The start as a shade, without the ground."""
        drawing = self.at(0, is_ghost=True)
        drawing.dots = []
        drawing.surfaces = [s for s in drawing.surfaces if s.colours != [GROUND]]
        for surface in drawing.surfaces:
            surface.colours, surface.values, surface.is_flat = [GHOST], None, True
            surface.which = np.zeros_like(surface.which)
        for one in drawing.lines:
            one.colour, one.values = GHOST, None
        return drawing

    def extent(self, number: float) -> np.ndarray:
        """Points (n, 3) that a picture of this state must hold; the ground is infinite.

        None where all that was shown is deleted or cut off, or the ground is all there is.
        """
        outermost_points = [np.empty((0, 3))]
        for name in self.drawn:
            points = self.positions(number, name)
            used = self._used_points(name, number)
            if name in FIXED:
                # the ground may extend beyond the parts that are shown, and roads do
                is_wider = name == "roads" or self.appearance.show
                used = used[:0] if is_wider else np.setdiff1d(used, self.planes)
            outermost_points.append(points[used])
            if name == "beams" and len(used):
                outermost_points += [
                    ring.reshape(-1, 3) for _, _, ring in self._outlines(number, points)
                ]
        points = np.concatenate(outermost_points)
        if self.half:
            normal, offset = self.half
            is_cut_off = not np.any(points @ normal <= offset)
            points = points[:0] if is_cut_off else clamped(points, self.half)
        return outermost(points) if len(points) else points

    def footprints(self, near: np.ndarray) -> np.ndarray:
        """Points of planes close below points (n, 3), which belong in the picture as well."""
        return footprints(self._plane_corners(), near)

    def _plane_corners(self) -> list[np.ndarray]:
        if "ground" not in self.states.blocks:
            return []
        points = self.positions(0, "ground")
        return [points[row] for row in self.planes]

    def _spread(self, points: np.ndarray) -> np.ndarray:
        """Points of the ground with its planes cut to the region of the drawing."""
        if self.reach is None:
            return points
        points = points.copy()
        for row in self.planes:
            points[row] = cut(points[row], self.reach)
        return points

    def position(self, number: float, name: str) -> np.ndarray:
        """Position (3,) of a body or part at a state: mass centre, or mean of its points."""
        states = self.states
        if name in states.names["bodies"][1:]:
            row = states.names["bodies"].index(name) - 1
            at: np.ndarray = self.positions(number, "mass_centres")[row]
            return at
        if f"part_{name}" in states.blocks:
            return self.positions(number, f"part_{name}").mean(axis=0)
        if name in states.names["parts"] and "beams" in states.blocks:
            part = states.names["parts"].index(name)
            rows = states.blocks["beams"].fixed["part"] == part
            return self.positions(number, "beams").reshape(-1, 2, 3)[rows].mean(axis=(0, 1))
        known = [*states.names["bodies"][1:], *states.names["parts"]]
        raise unknown("body or part", name, known)

    def positions(self, number: float, name: str) -> np.ndarray:
        """Points (n, 3) of a block as they are drawn, with displacements magnified."""
        present = self._between(number, name)
        if self.appearance.magnify == 1.0 or name == "contacts":
            return present
        start = self.states.blocks[name].points
        magnified: np.ndarray = start + self.appearance.magnify * (present - start)
        return magnified

    def _between(self, number: float, name: str) -> np.ndarray:
        """Points (n, 3) of a block; interpolated between two states.

        What turns so far from state to state that a straight path would shrink it stays where it
        was at the nearer of both.
        """
        before = self.states.positions(int(number), name)
        share = number - int(number)
        if share < LEAST_SHARE or name == "contacts":
            return before
        after = self.states.positions(int(number) + 1, name)
        between = before + share * (after - before)
        for _, corners in self.states.blocks[name].cells:
            if corners.shape[1] > 1:
                lengths = [first_edges(points, corners) for points in (before, after, between)]
                if np.any(lengths[2] < MAX_SHRUNK * np.minimum(lengths[0], lengths[1])):
                    return before if share < 0.5 else after
        return between

    def values(self, number: float, block: str) -> np.ndarray | None:
        """The colour's field on the cells (m,) of a block; None without it."""
        if not self.appearance.color or block not in self.states.blocks:
            return None
        name, mesh = self.appearance.color, self.states.blocks[block]
        names = [n for n in self.states.fields(block) if n == name or n.startswith(f"{name}_")]
        if name in names:
            names = [name]
        fields = [v for v in self.states.read(int(number), block, *names).values()]
        if not fields:
            return None
        self.color_unit = self.states.units.get(names[0], "")
        # vectors in space are those of points
        is_nodal = fields[0].ndim == 2 or len(fields[0]) != mesh.n_cells
        flat = [np.linalg.norm(v, axis=1) if v.ndim == 2 else v.astype(float) for v in fields]
        # of several fields of this name, such as those of the layers, the largest counts
        values: np.ndarray = np.max(flat, axis=0)
        if not is_nodal:
            return values
        cells = np.empty(mesh.n_cells)
        for rows, corners in mesh.cells:
            cells[rows] = values[corners].mean(axis=1)
        return cells

    def range(self, number: float) -> tuple[float, float]:
        """Least and greatest value of the colour among the parts drawn at a state."""
        low, high = np.inf, -np.inf
        for name in self.drawn:
            values = None if name in UNCOLOURED else self.values(number, name)
            if values is not None:
                values = values[self._cells_shown(name) & self.states.visible(int(number), name)]
            if values is not None and len(values):
                low, high = min(low, values.min()), max(high, values.max())
        return float(low), float(high)

    @property
    def arrow_unit(self) -> str:
        """Unit of the arrows."""
        return "m/s" if self.appearance.arrows == "velocity" else "N"

    def legend(self) -> list[tuple[str, str]]:
        """Names of the parts drawn in their own colours, with the colours, and section cuts.

        No parts by a field, or where colours come again: they only distinguish neighbours then.
        """
        cuts = {"section cut": SECTION} if self.sections else {}
        if self.appearance.color:
            return list(cuts.items())
        names, entries = self.states.names, dict[str, str]()
        for name in ("bodies", "links"):
            block = self.states.blocks.get(name)
            numbers = block.fixed.get("body", ()) if block else ()
            for body in np.unique(numbers):
                if int(body) in self.bodies:
                    entries.setdefault(self._label(int(body)), self._body_colour(int(body)))
        for body in self._without_shape():
            entries.setdefault(self._label(body), self._body_colour(body))
        for k, part in enumerate(names["parts"]):
            if part in self.parts:
                entries[self._part_label(k)] = self._part_colour(k)
        has_own = len(set(entries.values())) == len(entries)
        return list(((entries if has_own else {}) | cuts).items())

    def _shown(self) -> tuple[set[int], set[str]]:
        """Numbers of the bodies and names of the parts that the look shows."""
        bodies, parts = self.states.names["bodies"], self.states.names["parts"]
        if not self.appearance.show:
            return set(range(1, len(bodies))), set(parts)
        shown, selected = set[int](), set[str]()
        for word in self.appearance.show:
            matching = {k for k, name in enumerate(bodies) if k and fnmatchcase(name, word)}
            # bodies whose names begin with that of another are shown with it
            matching |= {k for k in range(1, len(bodies)) if self.groups[k] in matching}
            own = {name for name in parts if fnmatchcase(name, word)}
            if not matching and not own and word not in self.states.blocks.keys() & THICKNESS:
                raise unknown("body or part", word, [*bodies[1:], *parts])
            shown |= matching
            selected |= own
        return shown, selected

    def _check_color(self) -> None:
        word = self.appearance.color
        blocks = [name for name in self.drawn if name not in UNCOLOURED]
        known = {f for name in blocks for f in self.states.fields(name)}
        known -= {"points", "vtkGhostType", "side", "rotation", "section"}
        if not any(name == word or name.startswith(f"{word}_") for name in known):
            raise unknown("colour", word, sorted(known))

    def forces(self, number: float) -> tuple[np.ndarray, np.ndarray]:
        """Starting points of arrows (n, 3), and the vectors they show."""
        return forces_of(self, number, self.contacts)

    def _used_points(self, name: str, number: float) -> np.ndarray:
        """Numbers of the points of cells that are drawn."""
        block = self.states.blocks[name]
        if name == "mass_centres":
            return np.array(sorted(self.bodies), int) - 1
        shown = self._cells_shown(name) & self.states.visible(int(number), name)
        used = [np.unique(corners[shown[rows]]) for rows, corners in block.cells]
        return np.unique(np.concatenate(used)) if used else np.empty(0, int)

    def _cells_shown(self, name: str) -> np.ndarray:
        """Mask of the cells (m,) of a block that are shown."""
        block = self.states.blocks[name]
        everything = np.ones(block.n_cells, bool)
        if name in WHOLE and "body" in block.fixed:
            return np.isin(block.fixed["body"].astype(int), list(self.bodies))
        if name.startswith("part_"):
            return everything & (name.removeprefix("part_") in self.parts)
        if name == "beams" and "part" in block.fixed:
            own = [self.states.names["parts"].index(part) for part in self.parts]
            return np.isin(block.fixed["part"].astype(int), own)
        show = self.appearance.show
        return everything & (not show or name in FIXED or name in THICKNESS.keys() & set(show))

    def _body_colour(self, body: int) -> str:
        return COLOURS[self.hues[self._label(body)] % len(COLOURS)]

    def _label(self, body: int) -> str:
        """Label of a body in legends: of a node with a surface, that of its part."""
        part = self.owners[body]
        if part is not None:
            return self._part_label(part)
        return self.labels[self.wholes.index(self.groups[body])]

    def _part_colour(self, number: int) -> str:
        return COLOURS[self.hues[self._part_label(number)] % len(COLOURS)]

    def _part_label(self, number: int) -> str:
        # those of parts come after those of bodies
        return self.labels[len(self.wholes) + number]

    def _skin(self, drawing: Drawing, number: float, name: str, points: np.ndarray) -> None:
        """Surfaces of bodies, of the ground and of shells."""
        block = self.states.blocks[name]
        if name == "ground":
            points = self._spread(points)
        requested = self._cells_shown(name)
        shown = requested & self.states.visible(int(number), name)
        values = None if name in FIXED else self.values(number, name)
        palette, which = [GREY], np.zeros(block.n_cells, int)
        if name in FIXED:
            palette = [GROUND]
            # planes seen from their edge are lines
            if name == "ground" and len(self.planes):
                round_ = points[self.planes]
                ends = np.stack([round_, np.roll(round_, -1, axis=1)], axis=2).reshape(-1, 2, 3)
                drawing.lines.append(Lines(ends, GREY, 0.8))
        elif name == "bodies" and not self.appearance.color and "body" in block.fixed:
            bodies = block.fixed["body"].astype(int)
            palette = [self._body_colour(k) if k else GREY for k in range(len(self.groups))]
            which = bodies
        elif name.startswith("part_") and not self.appearance.color:
            part = name.removeprefix("part_")
            palette = [self._part_colour(self.states.names["parts"].index(part))]
        if name.startswith("part_") or name == "roads":
            edges, rows = self._borders(name)
            # as many lines at each state: those of deleted elements have no length
            ends = points[np.where(shown[rows][:, None], edges, edges[:, :1])]
            if requested[rows].any():
                drawing.lines.append(Lines(ends, GREY if name in FIXED else LINE, 1.0))
        for rows, corners in block.cells:
            selected = shown[rows]
            # as many surfaces at each state, also where one has lost all of its elements
            if not requested[rows].any() or corners.shape[1] not in (3, 4):
                continue
            planes = {"ground": self.planes, "roads": np.arange(len(points))}.get(name)
            for own, is_plane in by_light(corners, selected, planes):
                drawing.surfaces.append(
                    Surface(
                        points,
                        corners[own],
                        palette,
                        which[rows][own],
                        rows[own],
                        None if values is None else values[rows][own],
                        edges=name.startswith("part_"),
                        is_flat=is_plane,
                        one_sided=is_plane,
                    )
                )

    def _beams(self, drawing: Drawing, number: float, points: np.ndarray) -> None:
        """Elements of beams with their sections."""
        block, shown = self.states.blocks["beams"], self._cells_shown("beams")
        values, ends = self.values(number, "beams"), points.reshape(-1, 2, 3)
        if "side" not in block.fixed:
            drawing.lines.append(Lines(ends[shown], LINE, 3.0))
            return
        part = block.fixed["part"].astype(int)
        palette = [GREY]
        if not self.appearance.color:
            palette = [self._part_colour(k) for k in range(len(self.states.names["parts"]))]
        for own, corners, ring in self._outlines(number, points):
            cloud, (sides, caps) = ring.reshape(-1, 3), prisms(len(own), corners)
            for polygons, repeat in ((sides, corners), (caps, 2)):
                which = np.zeros(len(polygons), int)
                if not self.appearance.color:
                    which = np.repeat(part[own], repeat)
                colour = None if values is None else np.repeat(values[own], repeat)
                drawing.surfaces.append(
                    Surface(cloud, polygons, palette, which, np.arange(len(which)), colour)
                )

    def _outlines(self, number: float, points: np.ndarray) -> Iterator[Outline]:
        shown = self._cells_shown("beams")
        return outlines(self.states, int(number), points, shown, self.appearance.magnify)

    def _lines(self, drawing: Drawing, number: float, name: str, points: np.ndarray) -> None:
        if self.appearance.show and name not in self.appearance.show:
            return
        values = self.values(number, name)
        drawing.lines.append(Lines(points.reshape(-1, 2, 3), LINE, THICKNESS[name], values))

    def _dots(self, drawing: Drawing, points: np.ndarray) -> None:
        """Mass centres of bodies without surfaces."""
        for body in self._without_shape():
            drawing.dots.append(Dots(points[[body - 1]], self._body_colour(body)))

    def _without_shape(self) -> list[int]:
        """Bodies without surfaces, of which the mass centre is drawn."""
        block = self.states.blocks.get("bodies")
        hidden = set() if block is None else set(block.fixed.get("body", np.empty(0)).astype(int))
        return sorted((self.bodies & self.own) - hidden)

    def _links(self, drawing: Drawing, points: np.ndarray) -> None:
        block, shown = self.states.blocks["links"], self._cells_shown("links")
        (_, corners) = block.cells[0]
        bodies = block.fixed["body"].astype(int)
        for body in np.unique(bodies[shown]):
            own = points[corners[bodies == body]]
            drawing.lines.append(Lines(own, self._body_colour(int(body)), 4.0))

    def _borders(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        if name not in self._free_edges:
            self._free_edges[name] = borders(self.states.blocks[name])
        return self._free_edges[name]

    def shells_are_edge_on(self, towards: np.ndarray) -> bool:
        """Whether there are shells, and all are seen from their edges."""
        edge_on = []
        for name in self.drawn:
            if name.startswith("part_") and self._cells_shown(name).any():
                points = self.states.blocks[name].points
                for _, corners in self.states.blocks[name].cells:
                    if corners.shape[1] in (3, 4):
                        edge_on.append(are_edge_on(points, corners, towards))
        return bool(edge_on) and all(edge_on)
