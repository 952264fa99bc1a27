# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import FullTurn, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, FullTurn):
    node_c: int  # [index] body a of the second joint
    node_d: int  # [index] body b of the second joint
    axis_c: Numbers[float]  # [1] axis of the second joint, axes of its a
    side_c: Numbers[float]  # [1] from which its angle counts, axes of its a
    side_d: Numbers[float]  # [1] to which its angle counts, axes of its b
    ratio: float  # [1] angle of the second over angle of the first

class History:
    first: float  # [rad] angle of the first joint, over all revolutions
    second: float  # [rad] angle of the second joint, over all revolutions
