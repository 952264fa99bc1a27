"""Point driver: one world coordinate of a point of a body follows a curve of time.

    Phi = u . x_b - x(t),   nu = x'(t),   Phi_tt = -x''(t)     (x: _driven.py)

lambda is the driving force on the body. Consequence to test: a pendulum whose pivot is moved with
A sin(omega t) swings as if gravity were shaken.
"""

from typing import ClassVar, Literal

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.deck.card import BodyName, Vec3, quantity, word
from crashsolve.foundation.record import Record
from crashsolve.joints._card import POINTS, direction
from crashsolve.joints._driven import MOTION, DrivenCard, motion

# a travel along an axis of the ground: the kernels are those of the slide driver
from crashsolve.joints.translation_driver import (
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

    body: BodyName = word("body whose point is moved")
    at: Vec3 | None = quantity(
        "m",
        "the point at the start, in `frame`; the origin of the body when absent",
        default=None,
    )
    axis: Vec3 = word("direction of the coordinate at the start, in `frame`; any length")
    frame: Literal["world"] | BodyName = word(
        "frame of `at` and `axis`: world, or a body's own frame", default="world"
    )


def build(card: PointDriver, scene: Scene) -> Columns:
    node = scene.node(card.body)
    if node == 0:
        raise scene.fail("the ground cannot be moved; name another body", "body")
    u, x = direction(card, scene, "axis"), _point(card, scene, node)
    start = float(u @ x)
    tolerance = scene.deck.control.constraint_tolerance * scene.size
    frame = {
        "node_a": 0,
        "node_b": node,
        "point_a": np.zeros(3),
        "point_b": scene.to_body(node, x),
        "axis_a": u,
    }
    return motion(card, scene, start, slide_rate(frame, scene), tolerance) | frame


def _point(card: PointDriver, scene: Scene, node: int) -> np.ndarray:
    """Position of the point at the start, world axes [m]."""
    if card.at is None:
        point: np.ndarray = scene.world_point(node, (0.0, 0.0, 0.0))
    elif card.frame == "world":
        point = np.asarray(card.at, float)
    else:
        point = scene.world_point(scene.node(card.frame), card.at)
    return point
