"""Point driver: one world coordinate of a point of a body follows a curve of time.

    Phi = u . x_b - x(t),   nu = x'(t),   Phi_tt = -x''(t)     (x: _driven.py)

lambda is the driving force on the body. Consequence to test: a pendulum whose pivot is moved with
A sin(omega t) swings as if gravity were shaken.
"""

from typing import Any, ClassVar

import numpy as np

from crashsolve.deck.card import BodyName, Vec3, quantity, word
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS
from crashsolve.joints._driven import MOTION, DrivenCard, motion

# a travel along an axis of the ground: the kernels are those of the slide driver
from crashsolve.joints.slide_driver import (
    ANGULAR,
    ROWS,
    convective,
    jacobian,
    residual,
    slide_rate,
)

__all__ = ["ANGULAR", "ROWS", "convective", "jacobian", "residual"]

CONSTRAINTS = ()
CURVES_OF_TIME = ("curve",)
PARAMETERS = (
    POINTS
    + Record("""
    axis_a  1      3  u, world axes
""")
    + MOTION
)


class PointDriver(DrivenCard):
    """Prescribes the coordinate of a point of a body along a world direction."""

    curve_axes: ClassVar = {
        "curve": ("s", "m"),
        "velocity": ("s", "m/s"),
        "acceleration": ("s", "m/s^2"),
    }

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
    frame = {
        "node_a": 0,
        "node_b": node,
        "point_a": np.zeros(3),
        "point_b": scene.from_mass_centre(node, card.at),
        "axis_a": u,
    }
    return motion(card, scene, start, slide_rate(frame, scene), tolerance) | frame
