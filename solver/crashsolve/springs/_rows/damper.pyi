# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringOutput, SpringPoints

class Parameters(SpringPoints):
    curve: int  # [index] c
    largest_slope: float  # [N s/m] largest slope of the curve

class History(ForceHistory):
    segment: int  # [index] of the curve that is read

class Output(ForceOutput, SpringOutput): ...
