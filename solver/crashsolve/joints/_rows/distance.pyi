# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import JointPoints, RowParameters

class Parameters(RowParameters, JointPoints):
    length: float  # [m] L
