# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import BeamElement, BeamOutput, ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters(BeamElement):
    rotation: Numbers[float]  # [1] unit quaternion Q, element to nodes

class History(ForceHistory): ...

class Output(ForceOutput, BeamOutput): ...
