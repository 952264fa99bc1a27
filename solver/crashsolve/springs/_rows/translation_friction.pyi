# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b
    axis_a: Numbers[float]  # [1] direction in which b slides, axes of a
    level: float  # [N or N m] constant part of the limit
    friction_coefficient: float  # [1 or m] mu, times the pin radius: limit per pressing force
    first_row: int  # [index] first row of the joint
    pressing: int  # [count] rows whose reactions press the joint
    stiffness: float  # [N/m or N m/rad] K
    damping: float  # [N s/m or N m s/rad] c

class History(ForceHistory):
    pressing: float  # [N] force that pressed the joint at the start of the step
    limit: float  # [N or N m] at which it slides
    step: float  # [s] length of the step; 0 before the first
    travel: float  # [m] of b from the start
    slider: float  # [m] travel without stretch of the bristle
    force: float  # [N] F
    slid: float  # [m] distance slid

class Output(ForceOutput):
    force: float  # [N] positive pushes b back along the axis
    limit: float  # [N] at which it slides
    slid: float  # [m] distance slid so far
