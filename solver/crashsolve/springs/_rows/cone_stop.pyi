# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, RangeMoment, Slider
from crashsolve.foundation.rows import Numbers

class Parameters(RangeMoment):
    node_a: int  # [index] body that carries the cone
    node_b: int  # [index] body of the pointer
    reversed: int  # [flag] 1: the second body of the joint carries the cone
    axis_a: Numbers[float]  # [1] c, axes of a
    side_a: Numbers[float]  # [1] direction of azimuth 0, axes of a
    third_a: Numbers[float]  # [1] c x side, axes of a
    pointer: Numbers[float]  # [1] s, axes of b
    points: int  # [count] of azimuths
    azimuth: Numbers[float]  # [rad] rising
    narrow: Numbers[float]  # [1] f = 1 / theta_l^2 there
    stretch: float  # [1] largest |grad e|^2 at the limit

class History(ForceHistory, Slider): ...

class Output(ForceOutput):
    torque: float  # [N m] M, against the swing
    swing: float  # [rad] theta, of the pointer from the axis of the cone
    azimuth: float  # [rad] phi, of the pointer
    margin: float  # [rad] to the limit; negative past it
    energy: float  # [J] stored
    moment: Numbers[float]  # [N m] on the second body of the joint, its axes
