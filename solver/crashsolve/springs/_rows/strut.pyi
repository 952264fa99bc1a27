# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringOutput, SpringPoints

class Parameters(SpringPoints):
    length: float  # [m] l_0
    stiffness: float  # [N/m] of the spring; not used with a curve
    curve: int  # [index] y; 0 for none
    bump_damping: float  # [N s/m] c_b
    rebound_damping: float  # [N s/m] c_r
    damping_curve: int  # [index] D; 0 for none
    bump_length: float  # [m] l_b; minus infinity for none
    bump_stiffness: float  # [N/m] of the bump stop
    bump_curve: int  # [index] B; 0 for none
    rebound_length: float  # [m] l_r; infinity for none
    rebound_stiffness: float  # [N/m] of the rebound stop
    rebound_curve: int  # [index] R; 0 for none
    largest_slope: float  # [N/m] largest slope of spring and stop together
    largest_damping: float  # [N s/m] largest slope of the damper

class History(ForceHistory): ...

class Output(ForceOutput, SpringOutput):
    spring: float  # [N] part of the spring
    damper: float  # [N] part of the damper
    stop: float  # [N] part of the stops
