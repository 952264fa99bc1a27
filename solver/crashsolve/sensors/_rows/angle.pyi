# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import FullTurn

class Parameters(FullTurn): ...

class History:
    angle: float  # [rad] counted rotation

class Output:
    angle: float  # [rad] rotation of b from the start
    rate: float  # [rad/s] of the angle
