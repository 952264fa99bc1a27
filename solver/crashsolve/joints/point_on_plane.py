"""Point on plane: a point of b stays on a plane of a; the axis is the plane's normal.

    Phi = axis_a . (x_b - x_a) = 0

Consequence to test: five degrees of freedom; a ladder on a smooth wall and floor.
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import plane, rows_of

CONSTRAINTS = (plane,)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
PARAMETERS, build = FRAME, own_frame


class PointOnPlane(AxisJointCard):
    """The point `at` of b stays on the plane of a through `at` with the normal `axis`."""
