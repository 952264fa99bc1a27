# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node: int  # [index] body
    vector: Numbers[float]  # [N or N m] load where the factor is 1
    rotates: int  # [flag] the vector is fixed in the body
    curve: int  # [index] factor over time; 0 for none
    point: Numbers[float]  # [m] from the mass centre, body axes

class History(ForceHistory): ...

class Output(ForceOutput):
    force: Numbers[float]  # [N] world axes
