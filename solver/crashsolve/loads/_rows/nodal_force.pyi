# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    vector: Numbers[float]  # [N] F
    curve: int  # [index] factor over time; 0 for none
    mass: float  # [kg] of the nodes together; 0 if they share alike
    first_member: int  # [index] of the nodes among those of all entries
    member_count: int  # [count] nodes

class History(ForceHistory):
    factor: float  # [1] phi at the last step

class Output(ForceOutput):
    force: Numbers[float]  # [N] total, world axes
