# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, HingeLaw, HingeOutput, HingePath, JointFrame, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, HingeLaw, JointFrame):
    is_elliptic: int  # [flag] whether both moments share one ellipse
    reference: Numbers[float]  # [1] q_a^-1 q_b at the start
    rate_arm: float  # [m or 1] speed of the factor over the rate
    axial_yield: float  # [N] N_p of the section, which the joint exceeds; infinite if unknown
    buckling: float  # [N] compression to warn of; infinite if there is none

class History(ForceHistory, HingePath):
    flow_work: float  # [J] W, plastic work at which elliptic curves are read
    peak_axial: float  # [N] largest force along the beam so far, in magnitude
    peak_compression: float  # [N] largest compression along the beam so far

class Output(ForceOutput, HingeOutput):
    moment: Numbers[float]  # [N m] about side and about axis x side, positive rotates b back
    angle: Numbers[float]  # [rad] theta
    rate: Numbers[float]  # [rad/s] of the angle
    plastic_angle: Numbers[float]  # [rad] sum of plastic rotations in both directions
    residual_angle: Numbers[float]  # [rad] that would be left without moment
    peak_axial: float  # [N] largest force along the beam so far, in magnitude
