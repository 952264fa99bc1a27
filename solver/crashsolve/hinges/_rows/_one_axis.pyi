# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, HingeLaw, HingeOutput, HingePath, JointFrame, RowParameters

class Parameters(RowParameters, HingeLaw, JointFrame):
    rate_arm: float  # [m or 1] speed of the factor over the rate

class History(ForceHistory, HingePath): ...

class Output(ForceOutput, HingeOutput):
    moment: float  # [N m] positive rotates b back
    angle: float  # [rad] of b from the undeformed hinge
    rate: float  # [rad/s] of the angle
    plastic_angle: float  # [rad] sum of plastic rotations in both directions
    residual_angle: float  # [rad] that would be left without moment
