# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, HingeLaw, HingeOutput, HingePath, JointFrame, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, HingeLaw, JointFrame):
    is_elliptic: int  # [flag] whether both moments share one ellipse
    beam_a: Numbers[float]  # [1] direction of the beam, axes of a
    across_a: Numbers[float]  # [1] axis x beam, axes of a
    rate_arm: float  # [m] arm of the angle in the speed of the factor

class History(ForceHistory, HingePath):
    flow_work: float  # [J] W, plastic work at which elliptic curves are read

class Output(ForceOutput, HingeOutput):
    moment: float  # [N m] positive rotates b back
    force: float  # [N] pull is positive
    angle: float  # [rad] of b from the undeformed hinge
    stroke: float  # [m] of b along the beam from the undeformed hinge
    rate: float  # [rad/s] of the angle
    stroke_rate: float  # [m/s] of the stroke
    plastic_angle: float  # [rad] sum of plastic rotations in both directions
    residual_angle: float  # [rad] that would be left without moment and force
    plastic_stroke: float  # [m] sum of plastic displacements in both directions
    residual_stroke: float  # [m] that would be left without moment and force
