# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    curve: int  # [index] y
    unloading_curve: int  # [index] u
    unloading_stiffness: float  # [N/m] k
    damping: float  # [N s/m] c

class History(ContactHistory):
    slider: float  # [m] s
    unloading_work: float  # [J] P
    recoverable: float  # [J] recoverable energy of the padding
    branch: int  # [index] LOADING, UNLOADING or BETWEEN at the end of the step

class Output(ContactOutput): ...
