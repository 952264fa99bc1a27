# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    segments: int  # [count] how many
    node: Numbers[int]  # [index] body of each fitting; the last is repeated
    point: Numbers[float]  # [m] fitting, or middle of its surface, from mass centre
    friction_coefficient: Numbers[float]  # [1] mu of rings and surfaces
    surface: Numbers[int]  # [flag] 0 for a point, else SPHERE, CYLINDER or ELLIPSOID
    axes: Numbers[float]  # [1] axes of each surface in its body, by rows
    semi: Numbers[float]  # [m] semi-axes; radius first, half length of cylinder
    sense: Numbers[float]  # [1] 1 or -1: how the belt turns about a cylinder
    turned: Numbers[float]  # [rad] angle about it between its neighbours at the start
    shortest: float  # [m] length below which a segment is taken as that long
    k: float  # [N] slope of unloading, or stiffness
    curve: int  # [index] y; 0 for none
    steepest: float  # [N] largest force over strain
    spool: int  # [flag] whether the belt begins on one
    pull: float  # [N] of its spring
    lock_time: float  # [s] infinite for none
    lock_acceleration: float  # [m/s^2] infinite for none
    lock_rate: float  # [m/s] infinite for none
    limiter: int  # [index] R; 0 for none
    fires: float  # [s] time of the pretensioner; infinite for none
    pretensioner: int  # [index] P
    winds: float  # [s] how long
    reserve: float  # [m] webbing on it at the start
    start: Numbers[float]  # [m] unstrained length of each segment at the start
    total: float  # [m] their sum
    first: float  # [N] force at the start

class History(ForceHistory):
    along: Numbers[float]  # [1] directions of the segments
    arrive: Numbers[float]  # [m] where the belt reaches each fitting, world axes
    leave: Numbers[float]  # [m] where it leaves
    half: Numbers[float]  # [m] half the arc on each surface
    split: Numbers[float]  # [m] middle of the arc from the point of its body that divides it
    excess: Numbers[float]  # [m] by which that point would be beyond an end of the arc in the step
    carried: Numbers[float]  # [m] webbing that goes with it past the end, and slack that is taken up, onwards
    middle: Numbers[float]  # [m] middle of the arc from the mass centre, body axes
    lies: Numbers[float]  # [1] direction of the belt there, body axes
    turned: Numbers[float]  # [rad] angle about a cylinder between its neighbours; tau of an ellipsoid
    begun: Numbers[float]  # [m] where the belt reaches an ellipsoid, its axes
    touches: Numbers[int]  # [flag] 1 where the belt lies on a surface; until clear of it -1 where a fitting was within it, -2 where it has slipped off
    has_lain: Numbers[int]  # [flag] 1 once the belt has lain on a surface
    slipped: int  # [flag] the belt has slipped off a surface
    lateral: Numbers[float]  # [rad] by which it slid across its direction, over a ball or an ellipsoid
    crossed: int  # [flag] it slid so by more than a right angle
    inside: int  # [flag] a fitting was within a surface
    beyond: int  # [flag] the belt lay on a cylinder beyond its ends
    locked: int  # [flag] whether it is
    mode: int  # [flag] NONE, FREE, PULLING, LOCKED or EMPTY in the step
    wound_in: float  # [m] s
    paid_out: float  # [m] w, since it is locked
    absorbed: float  # [J] energy taken by the spool
    speed: Numbers[float]  # [m/s] of its body
    steps: int  # [count] of the run, up to 2: with the second there is an acceleration
    early: int  # [flag] it locked by the first acceleration, or by the webbing of the first steps
    emptied: int  # [flag] it has run out of webbing
    webbing: Numbers[float]  # [m] L, unstrained length
    residual: Numbers[float]  # [m] S, residual elongation
    webbing_0: Numbers[float]  # [m] L before webbing flows, with what surfaces carry
    residual_0: Numbers[float]  # [m] S before
    tension: Numbers[float]  # [N] T
    slip: Numbers[float]  # [m] webbing that has passed each fitting, towards the end
    friction: float  # [J] lost at rings
    drawn: float  # [J] lost in webbing
    straight: Numbers[float]  # [m] length
    short: int  # [flag] a segment has reached zero length
    unsettled: int  # [count] steps of which the flows are not found
    unbalanced: float  # [N] largest force beyond friction, or within it at a ring that slips, in them
    iterations: int  # [count] of the search for the flows
    flow: Numbers[float]  # [m] q, that passes each fitting in the step
    grip: Numbers[float]  # [1] exp(mu beta)
    softens: Numbers[float]  # [N/m] fall of T over webbing that flows in
    moved: Numbers[float]  # [m] growth of S in the step
    direction: Numbers[int]  # [flag] 1 onwards, -1 back, 0 not
    above: Numbers[float]  # [1] part of the tridiagonal matrix
    change: Numbers[float]  # [m] of the flow in an iteration
    cleared: int  # [flag] rows of fittings, segments and surfaces that there are not are zero

class Output(ForceOutput):
    force: Numbers[float]  # [N] tension of each segment from the start of the route on
    length: Numbers[float]  # [m] present length of each segment
    webbing: Numbers[float]  # [m] its unstrained length
    strain: Numbers[float]  # [1] of each segment; negative: slack
    slip: Numbers[float]  # [m] webbing that has passed each fitting, towards the end of the route
    angle: Numbers[float]  # [rad] by which the belt turns at each fitting
    friction: float  # [J] lost at rings so far
    hysteresis: float  # [J] lost in webbing so far
    retractor: float  # [J] energy taken by the retractor so far; negative where it has done work
    pay_out: float  # [m] webbing that has left the retractor
    locked: int  # [count] 1 once the retractor is locked
