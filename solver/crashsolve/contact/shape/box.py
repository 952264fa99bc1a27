"""Box fixed in a body."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.contact.shape._placed import PLACED, PlacedCard, placement
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# rounding of the edges, in shares of the least half size
ROUNDING = 1e-3


class Box(PlacedCard):
    """Box fixed in a body."""

    size: Vec3 = quantity("m", "edges along the axes of the shape", gt=0)


PARAMETERS = PLACED + Record("half  m  3  half edges")


def build(card: Box, scene: Scene) -> list[Columns]:
    return [placement(card, scene) | {"half": 0.5 * np.array(card.size)}]


def curvature_radius(card: Box) -> float | None:
    """Flat."""
    return None


def bounding(element: Columns) -> tuple[ArrayLike, float]:
    """Centre (3,) [m] in body axes and radius [m] of an enclosing sphere."""
    return element["point"], float(np.linalg.norm(element["half"]))


def half_thickness(element: Columns) -> float:
    """Half the shortest edge [m]."""
    return float(min(element["half"]))


def half_width(element: Columns) -> float:
    """Half the middle one of its edges [m]."""
    return float(sorted(element["half"])[1])


def corners(element: Columns) -> list[Columns]:
    """The eight corners, as spheres of radius 0."""
    axes = element["axes"].reshape(3, 3)
    signs = product((-1.0, 1.0), repeat=3)
    points = (element["point"] + axes @ (element["half"] * np.array(s)) for s in signs)
    return [{"node": element["node"], "point": point, "radius": 0.0} for point in points]


def rounds(element: Columns) -> np.ndarray:
    """Semi-axes [m], by rows, of ellipsoids that sum up to this shape with rounded edges."""
    e = element.get("edge", ROUNDING * min(element["half"]))
    return np.full((3, 3), e) + np.diag(element["half"] - 3.0 * e)
