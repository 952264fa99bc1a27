# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b
    axis_a: Numbers[float]  # [1] direction in which b slides, axes of a
    lower: float  # [m or rad] lower stop; minus infinity for none
    upper: float  # [m or rad] upper stop; infinity for none
    stiffness: float  # [N/m or N m/rad] k; not used with a curve
    curve: int  # [index] force over the travel beyond the stop; 0 for none
    damping: float  # [N s/m or N m s/rad] c
    stiffest: float  # [N/m or N m/rad] largest slope of the force

class History(ForceHistory):
    at: int  # [flag] 1: beyond the upper stop, -1: beyond the lower, 0: between

class Output(ForceOutput):
    force: float  # [N] positive pushes b back
    travel: float  # [m] of b from the start
    rate: float  # [m/s] of the travel
