# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    acceleration: Numbers[float]  # [m/s^2] acceleration of free fall

class History(ForceHistory): ...

class Output(ForceOutput):
    force: Numbers[float]  # [N] total weight
