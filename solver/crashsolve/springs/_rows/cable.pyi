# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    count: int  # [count] how many points
    node: Numbers[int]  # [index] body of each point; the last is repeated
    point: Numbers[float]  # [m] each point from the mass centre, body axes
    stiffness: float  # [N/m] k
    damping: float  # [N s/m] c
    length: float  # [m] l_0

class History:
    taut: int  # [flag] whether it is longer than without tension
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class Output:
    force: float  # [N] tension
    length: float  # [m] present length
    elongation: float  # [m] present length less that without tension; negative: slack
    rate: float  # [m/s] of the length
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate
