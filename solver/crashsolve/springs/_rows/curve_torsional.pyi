# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    side_b: Numbers[float]  # [1] the same direction at the start, axes of b
    curve: int  # [index] y
    unloading: int  # [flag] SAME, SET or BETWEEN
    unloading_curve: int  # [index] u
    unloading_stiffness: float  # [N/m or N m/rad] k
    only: int  # [flag] 1 or -1: no force in the other direction; 0: both
    loose: int  # [flag] the ends may part: never a force that holds them together
    gap: float  # [m or rad] free play in each direction
    damping: float  # [N s/m or N m s/rad] c
    rate_curve: int  # [index] phi over |rate|; 0 for the power law
    rate_coefficient: float  # [1] a
    rate_exponent: float  # [1] b
    rate_floor: float  # [m/s or rad/s] rate at which phi = 1.1
    stiffest: float  # [N/m or N m/rad] largest slope of the curves and k
    angle: float  # [rad] theta_0

class History(ForceHistory):
    set: Numbers[float]  # [m or rad] s in tension, in compression
    kept: Numbers[float]  # [J] P of both
    side: int  # [flag] 1 or -1: direction of the deformation
    branch: int  # [flag] SLACK, LINE, LOADING or LOWER
    segment: int  # [index] of the curve that is read
    angle: float  # [rad] counted rotation

class Output(ForceOutput):
    torque: float  # [N m] positive rotates b back
    angle: float  # [rad] rotation of b from the start
    rate: float  # [rad/s] of the angle
    set: float  # [rad] permanent rotation, the larger of both directions
