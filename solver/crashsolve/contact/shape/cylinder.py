"""Cylinder with flat caps, fixed in a body."""

from __future__ import annotations

from math import hypot, nan
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.contact.shape._placed import PLACED, carrier
from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Card, Vec3, quantity, word
from crashsolve.foundation.orientation import perpendicular
from crashsolve.foundation.record import Record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# rounding of the rims, in shares of the lesser half size
ROUNDING = 1e-3


class Cylinder(Card):
    """Cylinder with flat caps, fixed in a body."""

    body: BodyName = word("body the shape is fixed to", "ground")
    at: Vec3 = quantity("m", "centre, body axes", (0.0, 0.0, 0.0))
    axis: Vec3 = quantity("1", "direction, body axes; any length", (0.0, 0.0, 1.0))
    radius: float = quantity("m", "radius", gt=0)
    length: float = quantity("m", "length from cap to cap", gt=0)


PARAMETERS = PLACED + Record("""
    radius       m  radius
    half_length  m  from the centre to a cap, along axis 3
""")


def build(card: Cylinder, scene: Scene) -> list[Columns]:
    on = carrier(card.body, scene)
    axis = on.axes @ scene.unit(card.axis, "axis")
    side = perpendicular(axis)
    return [
        {
            "node": on.node,
            "point": on.point(card.at),
            "axes": np.column_stack([side, np.cross(axis, side), axis]).ravel(),
            "radius": card.radius,
            "half_length": 0.5 * card.length,
        }
    ]


def curvature_radius(card: Cylinder) -> float | None:
    """Not a number: a cylinder touches along lines, rims and caps."""
    return nan


def bounding(element: Columns) -> tuple[ArrayLike, float]:
    """Centre (3,) [m] in body axes and radius [m] of an enclosing sphere."""
    return element["point"], hypot(element["radius"], element["half_length"])


def half_thickness(element: Columns) -> float:
    """Radius, or half the length of a disc [m]."""
    return float(min(element["radius"], element["half_length"]))


def half_width(element: Columns) -> float:
    """Half the middle one of its three extents [m]."""
    return float(element["radius"])


def rounds(element: Columns) -> np.ndarray:
    """Semi-axes [m], by rows, of ellipsoids that sum up to this shape with rounded rims."""
    r, half = element["radius"], element["half_length"]
    e = element.get("edge", ROUNDING * min(r, half))
    return np.array([[r - e, r - e, e], [e, e, half - e]])


def rims(element: Columns) -> list[Columns]:
    """Two flat ellipsoids that reach exactly as far as the caps and the lateral surface."""
    axes = element["axes"].reshape(3, 3)
    r, half = element["radius"], element["half_length"]
    e = element.get("edge", ROUNDING * min(r, half))
    columns = {"node": element["node"], "axes": element["axes"], "semi": np.array([r, r, e])}
    centres = (element["point"] + side * (half - e) * axes[:, 2] for side in (-1.0, 1.0))
    return [columns | {"point": centre} for centre in centres]
