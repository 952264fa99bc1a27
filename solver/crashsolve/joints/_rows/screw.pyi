# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import JointFrame, RowParameters

class Parameters(RowParameters, JointFrame):
    advance: float  # [m/rad] h, travel over angle

class History:
    angle: float  # [rad] theta, over all revolutions
