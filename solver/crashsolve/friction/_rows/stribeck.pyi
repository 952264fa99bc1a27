# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    friction_static: float  # [1] mu_s
    friction_dynamic: float  # [1] mu_d
    friction_stribeck_speed: float  # [m/s] v_s
    friction_viscous: float  # [s/m] k_v
    friction_smoothing_speed: float  # [m/s] v_t

class History(ContactHistory): ...

class Output(ContactOutput): ...
