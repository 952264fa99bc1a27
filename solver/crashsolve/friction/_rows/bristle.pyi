# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters
from crashsolve.foundation.rows import Numbers

class Parameters(ContactParameters):
    friction_stiffness: float  # [N/m] k
    friction_damping_ratio: float  # [1] c / (2 sqrt(k m))
    friction_static: float  # [1] mu_s
    friction_dynamic: float  # [1] mu_d
    friction_stribeck_speed: float  # [m/s] v_s

class History(ContactHistory):
    bristle: Numbers[float]  # [m] elastic slip z of a over b

class Output(ContactOutput): ...
