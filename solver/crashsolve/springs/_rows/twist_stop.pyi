# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, RangeMoment, Slider
from crashsolve.foundation.rows import Numbers

class Parameters(RangeMoment):
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] c, axes of a
    side_a: Numbers[float]  # [1] direction of twist 0, axes of a
    axis_b: Numbers[float]  # [1] s, axes of b
    side_b: Numbers[float]  # [1] the same direction without twist, axes of b
    lower: float  # [rad] end of the range
    upper: float  # [rad] end of the range

class History(ForceHistory, Slider):
    angle: float  # [rad] tau, over all revolutions

class Output(ForceOutput):
    torque: float  # [N m] M, positive rotates b back
    angle: float  # [rad] tau, over all revolutions
    margin: float  # [rad] to the nearer limit; negative past it
    energy: float  # [J] stored
    moment: Numbers[float]  # [N m] on b, axes of b
