# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, Resistance, Slider, SpringOutput, SpringPoints

class Parameters(Resistance, SpringPoints):
    length: float  # [m] l_0

class History(ForceHistory, Slider): ...

class Output(ForceOutput, SpringOutput):
    elongation: float  # [m] present length less that without deformation
    set: float  # [m] permanent elongation, the larger of both directions
