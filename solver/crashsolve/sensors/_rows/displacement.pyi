# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] from the mass centre of b, axes of b
    is_attached: int  # [flag] components in axes of a
    start: float  # [m] distance at the start

class Output:
    distance: float  # [m] between the points
    change: float  # [m] of the distance since the start
    rate: float  # [m/s] of the distance
    vector: Numbers[float]  # [m] from a to b
    velocity: Numbers[float]  # [m/s] rate of the vector, in its axes
