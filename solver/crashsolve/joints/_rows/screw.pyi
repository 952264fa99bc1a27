# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters):
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] joint point from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] joint point from the mass centre of b, axes of b
    axis_a: Numbers[float]  # [1] joint axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    third_a: Numbers[float]  # [1] axis x side, axes of a
    axis_b: Numbers[float]  # [1] joint axis, axes of b
    side_b: Numbers[float]  # [1] side at the start, axes of b
    third_b: Numbers[float]  # [1] third at the start, axes of b
    advance: float  # [m/rad] h, travel over angle

class History:
    angle: float  # [rad] theta, over all revolutions
