# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringPoints
from crashsolve.foundation.rows import Numbers

class Parameters(SpringPoints):
    stiffness: Numbers[float]  # [N/m] diagonal of K
    damping: Numbers[float]  # [N s/m] diagonal of C
    rotational_stiffness: Numbers[float]  # [N m/rad] diagonal of K_r
    rotational_damping: Numbers[float]  # [N m s/rad] diagonal of C_r
    offset: Numbers[float]  # [m] x_0
    reference: Numbers[float]  # [1] q_a^-1 q_b at the start
    rotates: int  # [flag] whether it resists rotations, which end at half a revolution

class History(ForceHistory): ...

class Output(ForceOutput):
    force: Numbers[float]  # [N] f, on a, axes of a
    torque: Numbers[float]  # [N m] m, on a, axes of a
    displacement: Numbers[float]  # [m] x - x_0, axes of a
    angle: Numbers[float]  # [rad] theta, axes of a
