# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import VonMisesMetal, VonMisesSolid

class Parameters(VonMisesMetal):
    yield_stress: float  # [Pa] Y_0
    isotropic: float  # [Pa] (1 - beta) H
    curve: int  # [index] Y over plastic strain; 0 for none
    line_row: int  # [index] of a layer: value at no strain, slope and end of the line of a curve
    rate_D: float  # [1/s] D of Cowper and Symonds; 0 for none
    rate_q: float  # [1] q of Cowper and Symonds

class Solid(VonMisesSolid): ...
