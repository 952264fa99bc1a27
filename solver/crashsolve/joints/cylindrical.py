"""Cylindrical joint: b turns about and slides along one axis of a.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b ) = 0,   d = x_b - x_a

Consequence to test: two degrees of freedom that know nothing of each other: b falls along an
upright axis with g while it keeps its spin.
"""

from typing import Any

from crashsolve.joints._card import FRAME, AxisJointCard
from crashsolve.joints.basic import line, parallel, rows_of

CONSTRAINTS = (line, parallel)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("angle", "travel")
PARAMETERS = FRAME


class Cylindrical(AxisJointCard):
    """Sleeve on a shaft: b turns about and slides along one axis fixed in a."""


def build(card: Cylindrical, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))
