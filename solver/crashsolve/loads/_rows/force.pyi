# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import BodyLoad, ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters(BodyLoad):
    point: Numbers[float]  # [m] from the mass centre, body axes

class History(ForceHistory): ...

class Output(ForceOutput):
    force: Numbers[float]  # [N] world axes
