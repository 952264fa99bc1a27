"""Revolute joint (hinge): the points coincide and b rotates about one axis of a.

    Phi = ( x_b - x_a,  side_a . axis_b,  third_a . axis_b ) = 0      (Ambrosio (2003), Eq. 1)

side_a, third_a, axis_a are at right angles in body a. Consequence to test: one degree of freedom;
a pendulum on it has the period 4 K(sin(theta_0 / 2)) sqrt(L / g).
"""

from crashsolve.joints._card import FRAME, AxisJointCard, own_frame
from crashsolve.joints.basic import parallel, point, rows_of

CONSTRAINTS = (point, parallel)
ROWS, ANGULAR = rows_of(CONSTRAINTS)
FREE = ("angle",)
PARAMETERS, build = FRAME, own_frame


class Revolute(AxisJointCard):
    """Hinge: b rotates about one axis fixed in a."""
