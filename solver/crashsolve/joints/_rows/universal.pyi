# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import JointPoints, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, JointPoints):
    axis_a: Numbers[float]  # [1] arm of the cross in a, axes of a
    axis_b: Numbers[float]  # [1] arm of the cross in b, axes of b
