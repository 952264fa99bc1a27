# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    stiffness: float  # [N/m] k
    damping: float  # [N s/m] c
    damping_ratio: float  # [1] zeta, adds 2 zeta sqrt(k m) to c

class History(ContactHistory):
    mass_ratio: float  # [1] effective mass of the touch over that of its two bodies alone; 0: not known yet

class Output(ContactOutput): ...
