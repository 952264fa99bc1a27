# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import FullTurn, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters, FullTurn):
    node_c: int  # [index] body a of the rack's joint
    node_d: int  # [index] body b of the rack's joint
    point_c: Numbers[float]  # [m] point of the rack's joint from the mass centre of its a, axes of its a
    point_d: Numbers[float]  # [m] point of the rack's joint from the mass centre of its b, axes of its b
    axis_c: Numbers[float]  # [1] axis of the rack's joint, axes of its a
    radius: float  # [m] R

class History:
    angle: float  # [rad] angle of the pinion, over all revolutions
