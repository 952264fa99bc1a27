"""Point on line: a point of b stays on a line of a.

    Phi = ( side_a . d,  third_a . d ) = 0,   d = x_b - x_a

Consequence to test: four degrees of freedom; the ends of a ladder on a wall and a floor.
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import line, rows_of

CONSTRAINTS = (line,)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
PARAMETERS, build = FRAME, own_frame


class PointOnLine(AxisJointCard):
    """The point `at` of b stays on the line through `at` along `axis` of a."""
