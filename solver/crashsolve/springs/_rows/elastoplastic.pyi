# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringOutput, SpringPoints

class Parameters(SpringPoints):
    stiffness: float  # [N/m] k
    yield_force: float  # [N] F_y
    isotropic: float  # [N/m] H_i
    kinematic: float  # [N/m] H_k
    length: float  # [m] l_0

class History(ForceHistory):
    plastic: float  # [m] x_p
    flow: float  # [m] alpha
    plastic_flow: int  # [flag] 1 or -1: x_p grows or falls; 0: it rests

class Output(ForceOutput, SpringOutput):
    elongation: float  # [m] present length less that without force at the start
    set: float  # [m] plastic elongation
    flow: float  # [m] sum of plastic elongations in both directions
