# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    count: int  # [count] how many points
    node: Numbers[int]  # [index] body of each point; the last is repeated
    point: Numbers[float]  # [m] each point from the mass centre, body axes
    axis: Numbers[float]  # [1] a, axes of the body
    pivot: Numbers[float]  # [m] foot of each arm on the axis from the mass centre, axes of the body
    lever: Numbers[float]  # [m] arm from there to its end at the start, the same axes
    length: Numbers[float]  # [m] l of each link
    side: Numbers[float]  # [1] on which side of its dead centre a link is
    stiffness: float  # [N m/rad] k

class History(ForceHistory): ...

class Output(ForceOutput):
    force: float  # [N] of the left link, tension positive
    right: float  # [N] of the right link
    torque: float  # [N m] T, of the bar
    twist: float  # [rad] theta
    angles: Numbers[float]  # [rad] phi of both arms
