# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    acceleration: Numbers[float]  # [m/s^2] acceleration of free fall

class History:
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class Output:
    force: Numbers[float]  # [N] total weight
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate
