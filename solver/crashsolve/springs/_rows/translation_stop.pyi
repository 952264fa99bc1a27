# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringPoints, Stops
from crashsolve.foundation.rows import Numbers

class Parameters(Stops, SpringPoints):
    axis_a: Numbers[float]  # [1] direction in which b slides, axes of a

class History(ForceHistory):
    at: int  # [flag] 1: beyond the upper stop, -1: beyond the lower, 0: between

class Output(ForceOutput):
    force: float  # [N] positive pushes b back
    travel: float  # [m] of b from the start
    rate: float  # [m/s] of the travel
