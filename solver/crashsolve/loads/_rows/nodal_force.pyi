# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    vector: Numbers[float]  # [N] F
    curve: int  # [index] factor over time; 0 for none
    mass: float  # [kg] of the nodes together; 0 if they share alike
    first_member: int  # [index] of the nodes among those of all entries
    member_count: int  # [count] nodes

class History:
    factor: float  # [1] phi at the last step
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class Output:
    force: Numbers[float]  # [N] total, world axes
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate
