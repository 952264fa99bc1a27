# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    stiffness: float  # [N/m] k

class History(ContactHistory): ...

class Output(ContactOutput): ...
