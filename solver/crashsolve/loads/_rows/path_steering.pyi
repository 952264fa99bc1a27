# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    node_a: int  # [index] first body of the joint
    node_b: int  # [index] second body
    is_angle: int  # [flag] 1: of its angle, 0: of its travel
    point_a: Numbers[float]  # [m] point of the joint from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] the same of b, axes of b
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    side_b: Numbers[float]  # [1] the same direction at the start, axes of b
    vehicle: int  # [index] body that follows the path
    at: Numbers[float]  # [m] its point on the path from its mass centre, body axes
    forward: Numbers[float]  # [1] body axes
    path: int  # [index] y(s)
    origin: Numbers[float]  # [m] where s and y are 0
    along: Numbers[float]  # [1] direction of s
    left: Numbers[float]  # [1] direction of y
    up: Numbers[float]  # [1] normal of the plane
    wheelbase: float  # [m] L
    preview: float  # [s] T
    ahead: float  # [m] X_0
    ratio: float  # [m/rad or 1] n
    limit: float  # [rad] of delta
    stiffness: float  # [N/m or N m/rad] k
    relaxation: float  # [s] c / k

class History(ForceHistory):
    angle: float  # [rad] of the joint, over all revolutions

class Output(ForceOutput):
    force: float  # [N or N m] F, on the second body of the joint
    steering_angle: float  # [rad] delta, commanded by the driver
    target: float  # [m or rad] n delta
    coordinate: float  # [m or rad] x, of the joint since the start
    rate: float  # [m/s or rad/s] of it
    offset: float  # [m] of the vehicle from the path at its point, positive to the left
    preview_error: float  # [m] e, of the point that he aims at
