"""What a drawing is made of: polygons, segments, dots and arrows with their colours.

A painter (paint_vtk.py, paint_plain.py) needs nothing else.
"""

from dataclasses import dataclass, field, replace

import numpy as np

GREY, GROUND, LINE, ARROW, GHOST = "#9aa3ab", "#d8d3c8", "#4a535c", "#b3341f", "#b9c0c6"
SECTION = "#000000"
# distinguished by the colour-blind, and in grey by their lightness (Okabe and Ito 2008)
FEW = ("#0072b2", "#e69f00", "#56b4e9", "#cc79a7", "#009e73", "#f0e442", "#d55e00")
# where there are more bodies: darker and paler ones of other hues
COLOURS = (
    *FEW,
    *("#332288", "#882255", "#999933", "#44aa99", "#664433", "#aabbee", "#ff99bb", "#225533"),
    *("#bb88dd",),
)


@dataclass
class Surface:
    """Polygons of one number of corners, one colour or one value for each."""

    points: np.ndarray
    corners: np.ndarray
    colours: list[str]  # palette
    which: np.ndarray  # index in the palette, of each polygon
    rows: np.ndarray  # numbers of the polygons among those of the mesh, deleted ones left out
    values: np.ndarray | None = None
    edges: bool = False
    is_flat: bool = False  # of one colour in any light
    one_sided: bool = False  # seen from the outer side alone, as infinite planes and roads are

    def seen_from(self, towards: np.ndarray) -> "Surface":
        """Without planes between the eye and what is before them; `towards` (3,) the eye."""
        if not self.one_sided:
            return self
        a, b, c = (self.points[self.corners[:, k]] for k in range(3))
        outside = np.cross(b - a, c - a)
        # one seen from its edge is no wall
        size = np.maximum(np.linalg.norm(outside, axis=1), 1e-300)
        shown = outside @ towards >= -1e-9 * size
        return replace(
            self,
            corners=self.corners[shown],
            which=self.which[shown],
            rows=self.rows[shown],
            values=None if self.values is None else self.values[shown],
        )


@dataclass
class Lines:
    """Segments (n, 2, 3)."""

    ends: np.ndarray
    colour: str
    width: float = 1.6
    values: np.ndarray | None = None


@dataclass
class Dots:
    """Balls of one colour at points (n, 3)."""

    points: np.ndarray
    colour: str = LINE


@dataclass
class Drawing:
    """All that is seen at a moment."""

    surfaces: list[Surface] = field(default_factory=list)
    lines: list[Lines] = field(default_factory=list)
    dots: list[Dots] = field(default_factory=list)
    arrows: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)  # from, vector

    def take_floors(self) -> "Drawing":
        """A drawing of the planes and roads alone, which this one loses.

        All else lies on their outer side, and may be painted over them.
        """
        floors = Drawing([s for s in self.surfaces if s.one_sided])
        self.surfaces = [s for s in self.surfaces if not s.one_sided]
        return floors

    def scaled(self, origin: np.ndarray, length: float) -> "Drawing":
        """In units of a length [m] from an origin (3,) [m]; vectors of arrows as they are."""
        return Drawing(
            [replace(one, points=(one.points - origin) / length) for one in self.surfaces],
            [replace(one, ends=(one.ends - origin) / length) for one in self.lines],
            [replace(one, points=(one.points - origin) / length) for one in self.dots],
            [((start - origin) / length, vector) for start, vector in self.arrows],
        )
