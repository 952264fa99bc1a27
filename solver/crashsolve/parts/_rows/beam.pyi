# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import BeamElement, BeamOutput, ForceHistory, ForceOutput

class Parameters(BeamElement):
    buckling: float  # [N] compression to warn of; infinite if there is none

class History(ForceHistory):
    peak_compression: float  # [N] largest compression along the beam so far

class Output(ForceOutput, BeamOutput): ...
