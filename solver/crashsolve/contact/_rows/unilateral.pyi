# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    friction_coefficient: float  # [1] mu

class History:
    normal: Numbers[float]  # [1] n
    arm_a: Numbers[float]  # [m] point of contact from the node of side a
    arm_b: Numbers[float]  # [m] the same of side b
    opening: Numbers[float]  # [N s] impulse on side a in the first half of the step
    closing: Numbers[float]  # [N s] in the second half
    impulse: Numbers[float]  # [N s] of unilateral impulses, at the end of the step
    lift: float  # [m/s] normal velocity that keeps the gap closed on a curved surface
    friction_loss: float  # [J] lost by friction in the step
    velocity_before: Numbers[float]  # [m/s] velocity over b before a capture
    reaction: Numbers[float]  # [N] force on side a at the end of the step, without unilateral impulses
