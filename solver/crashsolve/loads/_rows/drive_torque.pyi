# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body of the joint
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_b: Numbers[float]  # [1] at right angles to the axis at the start, axes of b
    torque: float  # [N m] T
    curve: int  # [index] phi over time; 0 for none

class History(ForceHistory): ...

class Output(ForceOutput):
    torque: float  # [N m] on b about the axis
    rate: float  # [rad/s] of the angle
    moment: Numbers[float]  # [N m] on b, world axes
