# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b
    curve: int  # [index] c
    stiffest: float  # [N s/m] largest slope of the curve

class History(ForceHistory):
    segment: int  # [index] of the curve that is read

class Output(ForceOutput):
    force: float  # [N] tension positive
    length: float  # [m] present length
    rate: float  # [m/s] of the length
