"""Spherical joint (ball and socket): the points coincide.

    Phi = x_b - x_a = 0

Consequence to test: three degrees of freedom; a conical pendulum at the angle alpha goes round with
omega^2 = g / (L cos alpha).
"""

from typing import Any

from crashsolve.joints._card import POINTS, JointCard
from crashsolve.joints.basic import point, rows_of

CONSTRAINTS = (point,)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("ball",)
PARAMETERS = POINTS


class Spherical(JointCard):
    """Ball and socket: a point of b stays on a point of a."""


def build(card: Spherical, scene: Any) -> dict[str, Any]:
    return dict(scene.joint_frame(card))
