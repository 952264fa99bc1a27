# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b
    stiffness: float  # [N/m] k
    yield_force: float  # [N] F_y
    isotropic: float  # [N/m] H_i
    kinematic: float  # [N/m] H_k
    length: float  # [m] l_0

class History(ForceHistory):
    plastic: float  # [m] x_p
    flow: float  # [m] alpha
    plastic_flow: int  # [flag] 1 or -1: x_p grows or falls; 0: it rests

class Output(ForceOutput):
    force: float  # [N] tension positive
    length: float  # [m] present length
    elongation: float  # [m] present length less that without force at the start
    rate: float  # [m/s] of the length
    set: float  # [m] plastic elongation
    flow: float  # [m] sum of plastic elongations in both directions
