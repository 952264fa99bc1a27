# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    roads: int  # [count] how many
    kind: Numbers[int]  # [flag] PLANE, BOX, MESH or PROFILE
    road_node: Numbers[int]  # [index] body of each
    road_at: Numbers[float]  # [m] point or centre of each from its mass centre, body axes
    road_axes: Numbers[float]  # [1] its axes in the body, by rows; of a plane the normal is the third
    road_half: Numbers[float]  # [m] half edges of a box
    road_root: Numbers[int]  # [index] first box of the tree of a mesh, or curve of a profile
    thickness: Numbers[float]  # [m] of a mesh; infinite for a closed one
    node: int  # [index] wheel
    axis: Numbers[float]  # [1] u, wheel axes
    centre: Numbers[float]  # [m] of the wheel from its mass centre, wheel axes
    radius: float  # [m] R
    stiffness: float  # [N/m] k; not used with a curve
    curve: int  # [index] y; 0 for none
    stiffest: float  # [N/m] largest slope of the vertical force
    damping: float  # [N s/m] c
    damping_depth: float  # [m] depth over which it grows
    rim_depth: float  # [m] depth at which the rim is met; infinite for none
    rim_stiffness: float  # [N/m] k_rim
    friction_max: float  # [1] mu without slip
    friction_min: float  # [1] mu at slip 1
    length: float  # [m] l; 0 for the chord of the circle
    sigma_x: float  # [m] relaxation length along the wheel
    sigma_y: float  # [m] the same across
    still_damping: float  # [N s/m] k_V
    low_speed: float  # [m/s] V_low
    side_stiffness: float  # [N/m] of the carcass; infinite for none
    resistance: float  # [1] coefficient of rolling resistance
    C_x: float  # [N] longitudinal force over slip at zero
    C_y: float  # [N/rad] lateral force over slip at zero
    C_gamma: float  # [N/rad] lateral force over camber at zero

class History(ForceHistory):
    q_x: Numbers[float]  # [m] deflection of the carcass along the wheel, on each road
    q_y: Numbers[float]  # [m] the same across
    store: Numbers[float]  # [J] energy in it
    sunk: int  # [flag] whether its centre has been on a road or below it
    doubled: int  # [flag] whether two roads have pressed it from one side

class Output(ForceOutput):
    force: Numbers[float]  # [N] on the wheel, world axes
    moment: Numbers[float]  # [N m] on the wheel about its centre, world axes
    normal: float  # [N] F_z, sum over the roads
    longitudinal: float  # [N] F_x of the road pressed most
    lateral: float  # [N] F_y of that road
    aligning: float  # [N m] M_z of that road
    depth: float  # [m] delta of that road; negative: a gap
    slip: float  # [1] s_x of that road, positive drives
    side_slip: float  # [1] s_y of that road
    camber: float  # [rad] gamma on that road
    sliding: float  # [1] share of the patch that slides, there
