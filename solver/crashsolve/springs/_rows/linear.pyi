# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringOutput, SpringPoints

class Parameters(SpringPoints):
    stiffness: float  # [N/m] k
    damping: float  # [N s/m] c
    length: float  # [m] l_0

class History(ForceHistory): ...

class Output(ForceOutput, SpringOutput): ...
