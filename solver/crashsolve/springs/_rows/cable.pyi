# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    count: int  # [count] how many points
    node: Numbers[int]  # [index] body of each point; the last is repeated
    point: Numbers[float]  # [m] each point from the mass centre, body axes
    stiffness: float  # [N/m] k
    damping: float  # [N s/m] c
    length: float  # [m] l_0

class History(ForceHistory):
    taut: int  # [flag] whether it is longer than without tension

class Output(ForceOutput):
    force: float  # [N] tension
    length: float  # [m] present length
    elongation: float  # [m] present length less that without tension; negative: slack
    rate: float  # [m/s] of the length
