# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import VonMisesMetal, VonMisesSolid

class Parameters(VonMisesMetal):
    yield_stress: float  # [Pa] A
    power: float  # [Pa] B
    exponent: float  # [1] n
    rate_C: float  # [1] C
    rate_0: float  # [1/s] rate above which C counts
    softening: float  # [1] m

class Solid(VonMisesSolid): ...
