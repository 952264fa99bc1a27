# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
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
    stop_stiffness: float  # [N m/rad] k; not used with a curve
    transition: float  # [rad] d
    stop_damping: float  # [N m s/rad] c
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] c, axes of a
    side_a: Numbers[float]  # [1] direction of twist 0, axes of a
    axis_b: Numbers[float]  # [1] s, axes of b
    side_b: Numbers[float]  # [1] the same direction without twist, axes of b
    lower: float  # [rad] end of the range
    upper: float  # [rad] end of the range

class History(ForceHistory):
    set: Numbers[float]  # [m or rad] s in tension, in compression
    kept: Numbers[float]  # [J] P of both
    side: int  # [flag] 1 or -1: direction of the deformation
    branch: int  # [flag] SLACK, LINE, LOADING or LOWER
    segment: int  # [index] of the curve that is read

class Output(ForceOutput):
    torque: float  # [N m] M, positive rotates b back
    angle: float  # [rad] tau
    margin: float  # [rad] to the nearer limit; negative past it
    energy: float  # [J] stored
    moment: Numbers[float]  # [N m] on b, axes of b
