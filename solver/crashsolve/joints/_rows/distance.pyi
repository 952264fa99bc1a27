# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters):
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] joint point from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] joint point from the mass centre of b, axes of b
    length: float  # [m] L
