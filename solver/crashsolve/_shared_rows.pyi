# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class RowParameters:
    first_row: int  # [index] first constraint row

class ForceHistory:
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class ForceOutput:
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate

class ContactParameters:
    a: int  # [index] element on side a
    b: int  # [index] element on side b
    card: int  # [index] contact card
    order: int  # [count] +1 when a is on side a of the card, -1 when on side b
    speed_floor: float  # [m/s] closing speed below which a touch counts as resting
    thick: float  # [m] half thickness of both sides where they are thinnest; infinite with a plane
    spread_a: float  # [m] extent of the element on side a beyond its thickness
    spread_b: float  # [m] the same for side b

class ContactHistory:
    active: int  # [flag] touching
    depth: float  # [m] penetration; negative is a gap
    impact_speed: float  # [m/s] closing speed at the onset
    dissipated: float  # [J] by the normal force
    power: float  # [W] its present rate
    friction_dissipated: float  # [J] by friction
    friction_power: float  # [W] its present rate
    normal_force: Numbers[float]  # [N] normal force on side a
    friction_force: Numbers[float]  # [N] friction on side a
    bristle_energy: float  # [J] recoverable energy of friction
    position: Numbers[float]  # [m] point of contact

class ContactOutput:
    force: Numbers[float]  # [N] on side a
    point: Numbers[float]  # [m] point of contact
    stored: float  # [J] recoverable energy of the normal force
    friction_stored: float  # [J] recoverable energy of the friction bristle
    bound: float  # [m] of the depth of a pair that is skipped together with others, as their `depth` (model/contact/body_pairs.py); of others 0

class HingeLaw:
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

class HingePath:
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

class HingeOutput:
    rate_factor: float  # [1] phi, on the static moment or force at yield
    energy: float  # [J] taken so far: stored and dissipated
    failed: int  # [flag] 1 after failure

class JointFrame:
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

class JointPoints:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] joint point from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] joint point from the mass centre of b, axes of b

class BodyLoad:
    node: int  # [index] body
    vector: Numbers[float]  # [N or N m] load where the factor is 1
    rotates: int  # [flag] the vector is fixed in the body
    curve: int  # [index] factor over time; 0 for none

class RangeMoment:
    curve: int  # [index] y
    unloading: int  # [flag] SAME, SET or BETWEEN
    unloading_curve: int  # [index] u
    unloading_stiffness: float  # [N/m or N m/rad] k
    direction: int  # [flag] 1 or -1: no force in the other direction; 0: both
    loose: int  # [flag] the ends may part: never a force that holds them together
    gap: float  # [m or rad] free play in each direction
    damping: float  # [N s/m or N m s/rad] c
    rate_curve: int  # [index] phi over |rate|; 0 for the power law
    rate_coefficient: float  # [1] a
    rate_exponent: float  # [1] b
    rate_floor: float  # [m/s or rad/s] rate at which phi = 1.1
    largest_slope: float  # [N/m or N m/rad] largest slope of the curves and k
    stop_stiffness: float  # [N m/rad] k; not used with a curve
    transition: float  # [rad] d
    stop_damping: float  # [N m s/rad] c

class Resistance:
    curve: int  # [index] y
    unloading: int  # [flag] SAME, SET or BETWEEN
    unloading_curve: int  # [index] u
    unloading_stiffness: float  # [N/m or N m/rad] k
    direction: int  # [flag] 1 or -1: no force in the other direction; 0: both
    loose: int  # [flag] the ends may part: never a force that holds them together
    gap: float  # [m or rad] free play in each direction
    damping: float  # [N s/m or N m s/rad] c
    rate_curve: int  # [index] phi over |rate|; 0 for the power law
    rate_coefficient: float  # [1] a
    rate_exponent: float  # [1] b
    rate_floor: float  # [m/s or rad/s] rate at which phi = 1.1
    largest_slope: float  # [N/m or N m/rad] largest slope of the curves and k

class Slider:
    set: Numbers[float]  # [m or rad] s in tension, in compression
    unloading_work: Numbers[float]  # [J] P of both
    side: int  # [flag] 1 or -1: direction of the deformation
    branch: int  # [flag] SLACK, LINE, LOADING or LOWER
    segment: int  # [index] of the curve that is read

class Stops:
    lower: float  # [m or rad] lower stop; minus infinity for none
    upper: float  # [m or rad] upper stop; infinity for none
    stiffness: float  # [N/m or N m/rad] k; not used with a curve
    curve: int  # [index] force over the travel beyond the stop; 0 for none
    damping: float  # [N s/m or N m s/rad] c
    largest_slope: float  # [N/m or N m/rad] largest slope of the force

class Bristle:
    level: float  # [N or N m] constant part of the limit
    friction_coefficient: float  # [1 or m] mu, times the pin radius: limit per pressing force
    first_row: int  # [index] first row of the joint
    pressing: int  # [count] rows whose reactions press the joint
    stiffness: float  # [N/m or N m/rad] K
    damping: float  # [N s/m or N m s/rad] c

class JointPressure:
    pressing: float  # [N] force that pressed the joint at the start of the step
    limit: float  # [N or N m] at which it slides
    step: float  # [s] length of the step; 0 before the first

class SpringPoints:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b

class JointSlide:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    point_a: Numbers[float]  # [m] attachment from the mass centre of a, axes of a
    point_b: Numbers[float]  # [m] attachment from the mass centre of b, axes of b
    axis_a: Numbers[float]  # [1] direction in which b slides, axes of a

class SpringOutput:
    force: float  # [N] tension positive
    length: float  # [m] present length
    rate: float  # [m/s] of the length

class FullTurn:
    node_a: int  # [index] first body
    node_b: int  # [index] second body
    axis_a: Numbers[float]  # [1] axis, axes of a
    side_a: Numbers[float]  # [1] at right angles to the axis, axes of a
    side_b: Numbers[float]  # [1] the same direction at the start, axes of b

class BeamElement:
    node_a: int  # [index] first node
    node_b: int  # [index] second node
    length: float  # [m] l
    stiffness: Numbers[float]  # [N/m] diagonal of K
    rotational_stiffness: Numbers[float]  # [N m/rad] diagonal of K_r
    bowing: Numbers[float]  # [1] c_y and c_z
    damping: float  # [s] beta
    drag_a: float  # [1/s] alpha, times the element's share in its first node
    drag_b: float  # [1/s] the same of the second
    viscosity: float  # [N s/m] rho A c b_1, of the stretch
    quadratic_viscosity: float  # [N s^2/m^2] rho A b_2^2, of its square in compression
    rate_a: float  # [1/s^2] largest k times mobility at the first node
    rate_b: float  # [1/s^2] the same at the second
    tension_rate_a: float  # [1/(kg m)] increase of that by a tension of 1 N, at the first node
    tension_rate_b: float  # [1/(kg m)] the same at the second
    bow_coupling: float  # [1/m^0.5] root of the rate of a bow of 1 m over the rate, both nodes

class BeamOutput:
    force: Numbers[float]  # [N] tension, shear along y and z, axes of the element
    moment_a: Numbers[float]  # [N m] torsion, bending about y and z, at the first node
    moment_b: Numbers[float]  # [N m] torsion, bending about y and z, at the second node
    strain: Numbers[float]  # [1] stretch of the bent line, shear along y and z, u / l
    curvature: Numbers[float]  # [1/m] twist, bending about y and z, theta / l

class Tyre:
    roads: int  # [count] how many
    kind: Numbers[int]  # [flag] PLANE, BOX, MESH or PROFILE
    road_node: Numbers[int]  # [index] body of each
    road_at: Numbers[float]  # [m] point or centre of each from its mass centre, body axes
    road_axes: Numbers[float]  # [1] axes in the body, by rows; the third is the normal of a plane
    road_half: Numbers[float]  # [m] half edges of a box
    road_root: Numbers[int]  # [index] first box of the tree of a mesh, or curve of a profile
    thickness: Numbers[float]  # [m] of a mesh; infinite for a closed one
    node: int  # [index] wheel
    axis: Numbers[float]  # [1] u, wheel axes
    centre: Numbers[float]  # [m] of the wheel from its mass centre, wheel axes
    radius: float  # [m] R
    stiffness: float  # [N/m] k; not used with a curve
    curve: int  # [index] y; 0 for none
    largest_slope: float  # [N/m] largest slope of the vertical force
    damping: float  # [N s/m] c
    damping_depth: float  # [m] depth over which it grows
    rim_depth: float  # [m] depth at which the rim is met; infinite for none
    rim_stiffness: float  # [N/m] k_rim
    friction_max: float  # [1] mu without slip
    friction_min: float  # [1] mu at slip 1
    length: float  # [m] l; 0 for the chord of the circle
    sigma_x: float  # [m] relaxation length along the wheel
    sigma_y: float  # [m] the same across
    standstill_damping: float  # [N s/m] k_V
    low_speed: float  # [m/s] V_low
    side_stiffness: float  # [N/m] of the carcass; infinite for none
    resistance: float  # [1] coefficient of rolling resistance
    K_x: float  # [N/m] C_x / sigma_x
    K_y: float  # [N/m] C_y / sigma_y
    C_x: float  # [N] longitudinal force over slip at zero
    C_y: float  # [N/rad] lateral force over slip at zero
    C_gamma: float  # [N/rad] lateral force over camber at zero

class TyreDeflection:
    q_x: Numbers[float]  # [m] deflection of the carcass along the wheel, on each road
    q_y: Numbers[float]  # [m] the same across
    store: Numbers[float]  # [J] energy in it
    bottomed: int  # [flag] whether its centre has been on a road or below it
    roads_overlap: int  # [flag] whether two roads have pressed it from one side

class TyreForces:
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

class Roads:
    roads: int  # [count] how many
    kind: Numbers[int]  # [flag] PLANE, BOX, MESH or PROFILE
    road_node: Numbers[int]  # [index] body of each
    road_at: Numbers[float]  # [m] point or centre of each from its mass centre, body axes
    road_axes: Numbers[float]  # [1] axes in the body, by rows; the third is the normal of a plane
    road_half: Numbers[float]  # [m] half edges of a box
    road_root: Numbers[int]  # [index] first box of the tree of a mesh, or curve of a profile
    thickness: Numbers[float]  # [m] of a mesh; infinite for a closed one

class VonMisesMetal:
    young: float  # [Pa] E
    poisson: float  # [1] nu
    shear: float  # [Pa] G
    density: float  # [kg/m^3] rho
    plane: float  # [Pa] E / (1 - nu^2)
    across: float  # [1] nu / (1 - nu)
    softness: float  # [1/Pa] nu / E
    falls_1: float  # [Pa] c_1 of the plastic return
    falls_2: float  # [Pa] c_2
    kinematic: float  # [Pa] H_k, of what moves the yield surface
    rated: int  # [flag] whether the rate of strain has a factor
    heating: float  # [m^3/J] temperature, 1 at melting, over plastic work per volume; 0 for none
    temperature_row: int  # [index] of a layer
    failure: float  # [1] plastic strain at which a layer fails; 0 for none

class ElasticMaterial:
    young: float  # [Pa] E
    poisson: float  # [1] nu
    shear: float  # [Pa] G
    density: float  # [kg/m^3] rho
    plane: float  # [Pa] E / (1 - nu^2)
    across: float  # [1] nu / (1 - nu)

class VonMisesSolid:
    stress: Numbers[float]  # [Pa] xx, yy, zz, xy, yz, zx
    plastic_strain: float  # [1] e
    alpha: Numbers[float]  # [Pa] middle of the yield surface
    temperature: float  # [1] from 0 at the start to 1 at melting

class ElasticSolid:
    stress: Numbers[float]  # [Pa] xx, yy, zz, xy, yz, zx
