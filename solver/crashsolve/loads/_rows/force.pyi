# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    node: int  # [index] body
    vector: Numbers[float]  # [N or N m] load where the factor is 1
    rotates: int  # [flag] the vector is fixed in the body
    curve: int  # [index] factor over time; 0 for none
    point: Numbers[float]  # [m] from the mass centre, body axes

class History:
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class Output:
    force: Numbers[float]  # [N] world axes
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate
