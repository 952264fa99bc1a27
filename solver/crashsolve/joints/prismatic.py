"""Prismatic joint (slider): b slides along one axis of a and does not rotate against it.

    Phi = ( side_a . d,  third_a . d,  side_a . axis_b,  third_a . axis_b,  side_a . third_b ) = 0

with d = x_b - x_a. Consequence to test: one degree of freedom; b slides down an axis inclined by
alpha with g sin alpha.
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import line, parallel, rows_of, square

CONSTRAINTS = (line, parallel, square)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("travel",)
PARAMETERS, build = FRAME, own_frame


class Prismatic(AxisJointCard):
    """Slider: b moves along one axis fixed in a and does not rotate against a."""
