# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringPoints
from crashsolve.foundation.rows import Numbers

class Parameters(SpringPoints):
    first: Numbers[float]  # [1] first direction braked, axes of a
    second: Numbers[float]  # [1] second direction; 0 when only the first is braked
    offset: Numbers[float]  # [m] b from a at the start, axes of a
    force: float  # [N] F over the factor of the curve
    force_curve: int  # [index] factor over time; 0 for none
    stiffness: float  # [N/m] K
    damping: float  # [N s/m] c

class History(ForceHistory):
    slider: Numbers[float]  # [m] s_p, axes of a
    bristle: Numbers[float]  # [m] z, axes of a
    force: Numbers[float]  # [N] f, axes of a
    accumulated_slip: float  # [m] distance slid

class Output(ForceOutput):
    force: Numbers[float]  # [N] on b, axes of a
    limit: float  # [N] level at which it slides
    accumulated_slip: float  # [m] distance slid
