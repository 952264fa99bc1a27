# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, RowParameters
from crashsolve.foundation.rows import Numbers

class Parameters(RowParameters):
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] joint point from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] joint point from the mass centre of b, axes of b
    axis_a: Numbers[float]  # [1] joint axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    third_a: Numbers[float]  # [1] axis x side, axes of a
    axis_b: Numbers[float]  # [1] joint axis, axes of b
    side_b: Numbers[float]  # [1] side at the start, axes of b
    third_b: Numbers[float]  # [1] third at the start, axes of b
    stiffness: Numbers[float]  # [N m/rad or N/m] k of both motions
    backbone: Numbers[int]  # [index] y of both motions, in positive and negative direction
    cyclic: int  # [flag] ISOTROPIC, KINEMATIC or PEAK_ORIENTED
    initial: Numbers[float]  # [rad or m] motion from the start at which there is no moment
    failure: Numbers[float]  # [rad or m] motion at which the hinge fails; infinity for never
    is_apart: int  # [flag] whether failure frees the joint too
    rate_coefficient: float  # [1] a
    rate_exponent: float  # [1] b
    rate_floor: float  # [m/s or rad/s] speed at which phi = 1.1
    latched: int  # [flag] whether V is that at first yield
    rate_arm: float  # [m or 1] speed of the factor over the rate

class History(ForceHistory):
    x: Numbers[float]  # [rad or m] motion from the undeformed hinge
    speed: float  # [rad/s or m/s] V
    plastic: Numbers[float]  # [rad or m] x_p
    flow: Numbers[float]  # [rad or m] alpha
    reached: Numbers[float]  # [rad or m] largest x_p in positive and in negative direction of both motions
    origin: Numbers[float]  # [rad or m] x_0
    plastic_flow: Numbers[int]  # [flag] 1 or -1: x_p grows or falls; 0: it rests
    corner: Numbers[float]  # [rad or m] plastic displacement to the end of the segment of y
    factor: float  # [1] phi
    latch: float  # [m/s or rad/s] V at first yield; -1 before
    failed: int  # [flag] 1: there is no hinge any more

class Output(ForceOutput):
    rate_factor: float  # [1] phi, on the static moment or force at yield
    energy: float  # [J] taken so far: stored and dissipated
    failed: int  # [flag] 1 after failure
    moment: float  # [N m] positive rotates b back
    angle: float  # [rad] of b from the undeformed hinge
    rate: float  # [rad/s] of the angle
    plastic_angle: float  # [rad] sum of plastic rotations in both directions
    residual_angle: float  # [rad] that would be left without moment
