"""Planar joint: a plane of b slides on a plane of a; the joint axis is their normal.

    Phi = ( axis_a . (x_b - x_a),  side_a . axis_b,  third_a . axis_b ) = 0

Consequence to test: three degrees of freedom; on a level plane the mass centre runs straight with
constant speed while the body keeps its spin.
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import parallel, plane, rows_of

CONSTRAINTS = (plane, parallel)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("angle",)
PARAMETERS, build = FRAME, own_frame


class Planar(AxisJointCard):
    """b slides and rotates on a plane fixed in a; `axis` is the plane's normal."""
