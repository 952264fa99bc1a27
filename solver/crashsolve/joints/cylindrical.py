"""Cylindrical joint: b rotates about and slides along one axis of a.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b ) = 0,   d = x_b - x_a

Consequence to test: two degrees of freedom that know nothing of each other: b falls along an
upright axis with g while it keeps its spin.
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import line, parallel, rows_of

CONSTRAINTS = (line, parallel)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("angle", "travel")
PARAMETERS, build = FRAME, own_frame


class Cylindrical(AxisJointCard):
    """Sleeve on a shaft: b rotates about and slides along one axis fixed in a."""
