"""Spherical joint (ball and socket): the points coincide.

    Phi = x_b - x_a = 0

Consequence to test: three degrees of freedom; a conical pendulum at the angle alpha goes round with
omega^2 = g / (L cos alpha).
"""

from crashsolve.joints._card import POINTS, JointCard, own_frame
from crashsolve.joints.basic import point, rows_of

CONSTRAINTS = (point,)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("ball", "swing")
PARAMETERS, build = POINTS, own_frame


class Spherical(JointCard):
    """Ball and socket: a point of b stays on a point of a."""
