# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import BodyLoad, ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters(BodyLoad): ...

class History(ForceHistory): ...

class Output(ForceOutput):
    torque: Numbers[float]  # [N m] world axes
