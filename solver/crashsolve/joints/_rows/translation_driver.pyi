# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import JointPoints, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, JointPoints):
    axis_a: Numbers[float]  # [1] joint axis, axes of a
    curve: int  # [index] f
    integrals: int  # [count] of f that the coordinate is: 0 to 2
    start: float  # [s] time at which the run begins
    rate: float  # [m/s or rad/s] velocity at the first point of an acceleration
    offset: float  # [m or rad] of f, or of its integral, over the coordinate
