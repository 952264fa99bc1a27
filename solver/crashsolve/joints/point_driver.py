"""Point driver: one world coordinate of a point of a body follows a curve of time.

    Phi = u . x_b - ( f(t) - offset ),   nu = f'(t),   Phi_tt = -f''(t)

lambda is the driving force on the body. Consequence to test: a pendulum whose pivot is moved with
A sin(omega t) swings as if gravity were shaken.
"""

from typing import Any, ClassVar

import numpy as np

from crashsolve.deck.card import BodyName, Vec3, quantity, word
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS
from crashsolve.joints._driven import DrivenCard, motion

# a travel along an axis of the ground: the kernels are those of the slide driver
from crashsolve.joints.slide_driver import ANGULAR, ROWS, convective, jacobian, residual

__all__ = ["ANGULAR", "ROWS", "convective", "jacobian", "residual"]

CONSTRAINTS = ()
CURVES_OF_TIME = ("curve",)
PARAMETERS = POINTS + Record("""
    axis_a  1      3  u, world axes
    curve   index     f
    offset  m         of f over the coordinate
""")


class PointDriver(DrivenCard):
    """Prescribes the coordinate of a point of a body along a world direction."""

    curve_axes: ClassVar = {"curve": ("s", "m")}

    body: BodyName = word("body that is moved")
    at: Vec3 = quantity("m", "point in the body's frame", default=(0.0, 0.0, 0.0))
    axis: Vec3 = word("world direction of the coordinate; any length")


def build(card: PointDriver, scene: Any) -> dict[str, Any]:
    node = scene.node(card.body)
    if node == 0:
        raise scene.fail("the ground cannot be moved; name another body", "body")
    u = scene.unit(card.axis, "axis")
    start = float(u @ scene.world_point(node, card.at))
    tolerance = scene.deck.control.constraint_tolerance * scene.size
    return motion(card, scene, start, tolerance) | {
        "node_a": 0,
        "node_b": node,
        "point_a": np.zeros(3),
        "point_b": scene.from_mass_centre(node, card.at),
        "axis_a": u,
    }
