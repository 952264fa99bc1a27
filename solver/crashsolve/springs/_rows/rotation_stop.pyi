# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, FullTurn, Stops
from crashsolve.foundation.rows import Numbers

class Parameters(Stops, FullTurn):
    start: float  # [rad] angle at the start, of a posture

class History(ForceHistory):
    at: int  # [flag] 1: beyond the upper stop, -1: beyond the lower, 0: between
    angle: float  # [rad] theta, over all revolutions

class Output(ForceOutput):
    torque: float  # [N m] positive rotates b back
    angle: float  # [rad] of b from the start, or from the zero posture
    rate: float  # [rad/s] of the angle
    moment: Numbers[float]  # [N m] on b, axes of b
