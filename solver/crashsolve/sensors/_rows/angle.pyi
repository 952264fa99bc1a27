# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    side_b: Numbers[float]  # [1] the same direction at the start, axes of b

class History:
    angle: float  # [rad] counted rotation

class Output:
    angle: float  # [rad] rotation of b from the start
    rate: float  # [rad/s] of the angle
