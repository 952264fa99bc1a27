# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    friction_coefficient: float  # [1] mu
    friction_none_below: float  # [m/s] v_0
    friction_full_above: float  # [m/s] v_1

class History(ContactHistory):
    friction_regime: int  # [index] 0 below v_0, 1 between, 2 from v_1 on

class Output(ContactOutput): ...
