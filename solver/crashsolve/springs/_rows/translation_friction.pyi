# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import Bristle, ForceHistory, ForceOutput, JointPressure, SpringPoints
from crashsolve.foundation.rows import Numbers

class Parameters(Bristle, SpringPoints):
    axis_a: Numbers[float]  # [1] direction in which b slides, axes of a

class History(ForceHistory, JointPressure):
    travel: float  # [m] of b from the start
    slider: float  # [m] travel without stretch of the bristle
    force: float  # [N] F
    accumulated_slip: float  # [m] distance slid

class Output(ForceOutput):
    force: float  # [N] positive pushes b back along the axis
    limit: float  # [N] at which it slides
    accumulated_slip: float  # [m] distance slid
