# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    level: float  # [N or N m] constant part of the limit
    friction_coefficient: float  # [1 or m] mu, times the pin radius: limit per pressing force
    first_row: int  # [index] first row of the joint
    pressing: int  # [count] rows whose reactions press the joint
    stiffness: float  # [N/m or N m/rad] K
    damping: float  # [N s/m or N m s/rad] c
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] joint axis, axes of a; 0 for a ball
    torque_curve: int  # [index] phi over time; 0 for none

class History(ForceHistory):
    pressing: float  # [N] force that pressed the joint at the start of the step
    limit: float  # [N or N m] at which it slides
    step: float  # [s] length of the step; 0 before the first
    configuration: Numbers[float]  # [1] quaternion of b in a
    bristle: Numbers[float]  # [rad] z, axes of a
    torque: Numbers[float]  # [N m] M, axes of a
    slid: float  # [rad] angle slid

class Output(ForceOutput):
    torque: Numbers[float]  # [N m] on b, world axes
    moment: Numbers[float]  # [N m] the same, axes of b
    limit: float  # [N m] at which it slides
    slid: float  # [rad] angle slid so far
