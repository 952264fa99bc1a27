# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    side_b: Numbers[float]  # [1] the same direction at the start, axes of b
    lower: float  # [m or rad] lower stop; minus infinity for none
    upper: float  # [m or rad] upper stop; infinity for none
    stiffness: float  # [N/m or N m/rad] k; not used with a curve
    curve: int  # [index] force over the travel beyond the stop; 0 for none
    damping: float  # [N s/m or N m s/rad] c
    stiffest: float  # [N/m or N m/rad] largest slope of the force
    start: float  # [rad] angle at the start, of a posture

class History(ForceHistory):
    at: int  # [flag] 1: beyond the upper stop, -1: beyond the lower, 0: between
    angle: float  # [rad] theta, over all revolutions

class Output(ForceOutput):
    torque: float  # [N m] positive rotates b back
    angle: float  # [rad] of b from the start, or from the zero posture
    rate: float  # [rad/s] of the angle
