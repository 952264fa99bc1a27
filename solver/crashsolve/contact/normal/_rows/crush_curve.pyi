# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    curve: int  # [index] force over penetration
    unloading_stiffness: float  # [N/m] k
    damping: float  # [N s/m] c

class History(ContactHistory):
    crush: float  # [m] deepest loading so far, d
    recoverable: float  # [J] recoverable energy of the end
    is_loading: int  # [flag] whether it was being crushed at the end of the step

class Output(ContactOutput): ...
