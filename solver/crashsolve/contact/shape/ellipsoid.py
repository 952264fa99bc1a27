"""Ellipsoid fixed in a body."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.contact.shape._placed import PLACED, PlacedCard, placement
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import Vec3, quantity
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Ellipsoid(PlacedCard):
    """Ellipsoid fixed in a body."""

    semi_axes: Vec3 = quantity("m", "half lengths along the axes of the shape", gt=0)


PARAMETERS = PLACED + Record("semi  m  3  semi-axes")


def build(card: Ellipsoid, scene: Scene) -> list[Columns]:
    return [placement(card, scene) | {"semi": np.array(card.semi_axes)}]


def curvature_radius(card: Ellipsoid) -> float | None:
    """Radius for Hertz's stiffness [m]; not a number where it depends on the position."""
    a, b, c = card.semi_axes
    return a if a == b == c else nan


def bounding(element: Columns) -> tuple[ArrayLike, float]:
    """Centre (3,) [m] in body axes and radius [m] of an enclosing sphere."""
    return element["point"], float(max(element["semi"]))


def half_thickness(element: Columns) -> float:
    """Shortest semi-axis [m]."""
    return float(min(element["semi"]))


def half_width(element: Columns) -> float:
    """The middle one of its semi-axes [m]."""
    return float(sorted(element["semi"])[1])


def rounds(element: Columns) -> np.ndarray:
    """Semi-axes [m] of the one ellipsoid that this shape is."""
    return np.array([element["semi"]])
