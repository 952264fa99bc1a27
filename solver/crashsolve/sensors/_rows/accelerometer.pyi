# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    node: int  # [index] body
    point: Numbers[float]  # [m] from the mass centre, body axes
    free_fall: Numbers[float]  # [m/s^2] g, world axes; 0 when it is not subtracted
    has_role: int  # [flag] whether measures of injury need it

class Output:
    acceleration: Numbers[float]  # [m/s^2] of the point, body axes
    resultant: float  # [m/s^2] magnitude of the acceleration
    velocity: Numbers[float]  # [m/s] of the point, body axes
    angular_velocity: Numbers[float]  # [rad/s] of the body, body axes
