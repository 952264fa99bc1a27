# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, HingeLaw, HingeOutput, HingePath, JointFrame, RowParameters

class Parameters(RowParameters, HingeLaw, JointFrame): ...

class History(ForceHistory, HingePath): ...

class Output(ForceOutput, HingeOutput):
    force: float  # [N] pull is positive
    stroke: float  # [m] of b along the axis from the undeformed hinge
    rate: float  # [m/s] of the stroke
    plastic_stroke: float  # [m] sum of plastic displacements in both directions
    residual_stroke: float  # [m] that would be left without force
