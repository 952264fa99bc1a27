# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import Bristle, ForceHistory, ForceOutput, JointPressure
from crashsolve.foundation.rows import Numbers

class Parameters(Bristle):
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] joint axis, axes of a; 0 for a ball
    torque_curve: int  # [index] phi over time; 0 for none

class History(ForceHistory, JointPressure):
    configuration: Numbers[float]  # [1] quaternion of b in a
    bristle: Numbers[float]  # [rad] z, axes of a
    torque: Numbers[float]  # [N m] M, axes of a
    accumulated_slip: float  # [rad] sum of angles slid

class Output(ForceOutput):
    torque: Numbers[float]  # [N m] on b, world axes
    moment: Numbers[float]  # [N m] the same, axes of b
    limit: float  # [N m] at which it slides
    accumulated_slip: float  # [rad] sum of angles slid
