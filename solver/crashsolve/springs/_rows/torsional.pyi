# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, FullTurn

class Parameters(FullTurn):
    stiffness: float  # [N m/rad] k
    damping: float  # [N m s/rad] c
    angle: float  # [rad] theta_0

class History(ForceHistory):
    angle: float  # [rad] counted rotation

class Output(ForceOutput):
    torque: float  # [N m] positive rotates b back
    angle: float  # [rad] rotation of b from the start
    rate: float  # [rad/s] of the angle
