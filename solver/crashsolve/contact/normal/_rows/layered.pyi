# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ContactHistory, ContactOutput, ContactParameters

class Parameters(ContactParameters):
    stiffness: float  # [N/m^n] K
    exponent: float  # [1] n
    layer: float  # [m] d
    core_stiffness: float  # [N/m^n] K_c
    chi: float  # [1] damping factor of the law
    returned: float  # [1] restitution x of a free impact
    spent: float  # [1] G(1): share of m v_0^2 that drives a free impact to its deepest
    speed_limit: float  # [m/s] impact speed beyond which the law is outside its range

class History(ContactHistory):
    damping_speed: float  # [m/s] v_0
    too_fast: int  # [flag] an impact was faster than speed_limit
    pressed: int  # [flag] v_0 was that of the speed floor

class Output(ContactOutput): ...
