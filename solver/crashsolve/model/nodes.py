"""The node table and the constraint rows: the columns of every body and of every joint.

Every body is a node, a point with a triad; node 0 is the ground. World components unless said.
"""

from crashsolve.foundation.record import Record

# what most laws read stands together
NODE = Record("""
    r             m           3  position of the mass centre
    q             1           4  unit quaternion (w, x, y, z), body to world
    v             m/s         3  velocity of the mass centre
    w             rad/s       3  angular velocity
    force         N           3  applied force
    torque        N m         3  applied torque about the mass centre
    stiffness     1/s^2          sum of k times mobility, for the stable step
    damping       1/s            sum of c times mobility
    L             kg m^2/s    3  angular momentum about the mass centre
    mass_inv      1/kg           inverse mass; 0 for the ground
    is_attached   flag           whether it moves with a body (system/attachments.py)
    has_surface   flag           whether a contact may touch it
    A             1           9  rotation matrix of q, by rows
    W             1/(kg m^2)  9  inverse inertia at the present orientation
    joint_force   N           3  D^T lambda
    joint_torque  N m         3  D^T lambda about the mass centre
    v_half        m/s         3  velocity during the drift
    L_half        kg m^2/s    3  angular momentum during the drift
    start_r       m           3  at the start of the step
    start_v       m/s         3  at the start of the step
    start_L       kg m^2/s    3  at the start of the step
    start_q       1           4  at the start of the step
    start_A       1           9  at the start of the step
    moved         m           3  displacement of the mass centre in the step, where it bounds gaps
    rotated       1           3  2 tan(theta / 2) times the axis of its rotation, for the same
    J             kg m^2      9  inertia, body axes
    J_inv         1/(kg m^2)  9  inverse inertia, body axes
    deferred_force  N           3  part of force that began during the step
    deferred_torque  N m         3  part of torque that began during the step
    pressed       m/s^2          sum of normal force times mobility along the slip, where friction
                                 acts
    was_pressed   m/s^2          the same in the last step
    damped        1/s            sum of c times mobility of contacts whose damping is implicit
    was_damped    1/s            the same in the last step
    slip_rate     1/s            largest relative change of a slip per time, where friction acts
    reference     index          body of its mechanism, or the ground, to whose velocity work of
                                 joints is relative
    joint_work    J              work of joints, less that of drivers, in steps of many iterations
    joint_exchange  J              the same, taken and given both positive
    joint_unseen  J              work of joints over what they stand open by, in these steps
    largest_kinetic  J              largest kinetic energy in these steps
    external      N, N m      6  row 0: force and torque about the origin from outside
    v_dot         m/s^2       3  acceleration of the mass centre, at samples
    w_dot         rad/s^2     3  angular acceleration, at samples
""")

# of a scene in which contacts touch bodies that welds join to others: model/welded.py
WELDED = Record("""
    welded_first   index            first body of the rigid whole that welds make of it; itself
    welded_mass_inv  1/kg             inverse mass of the whole
    welded_at      m             3  mass centre of the whole from its own, body axes
    welded_J_inv   1/(kg m^2)    9  inverse inertia of the whole about that centre, body axes
    own_stiffness  1/s^2            part of stiffness that is not of contacts
    own_damping    1/s              part of damping that is not of contacts
""")

STAGE = Record("""
    rate_r         m/s    3  velocity at a stage of a Runge-Kutta step; ground: power of drivers [W]
    rate_rotation  1/s    3  of rotation
    rate_v         m/s^2  3  acceleration; ground: force from outside [N]
    rate_L         N m    3  moment about the mass centre; ground: from outside, about the origin
    rotation       1      3  Cayley vector of the rotation since the start of the step
""")

# a stage whose equations are solved by iteration
IMPLICIT_STAGE = STAGE + Record("""
    rate_w          rad/s^2  3  angular acceleration
    mean_v          m/s^2    3  weighted mean of accelerations in generalized-alpha
    mean_w          rad/s^2  3  the same of angular accelerations
    closing_r       m        3  displacement by which generalized-alpha closes the joints
    closing_w       rad      3  rotation by which it does
    past_v          m/s^2    3  acceleration at this stage of the step before
    past_w          rad/s^2  3  angular acceleration there
    displacement_r  m        3  displacement since the start of the step
    change_v        m/s      3  change of velocity since then
    change_w        rad/s    3  change of angular velocity since then
    right_r         m        3  residual of displacement_r
    right_rotation  1        3  residual of rotation
    right_v         m/s      3  residual of change_v
    right_w         rad/s    3  residual of change_w
    slope_r         m/s      3  change of rate_r by the last correction
    slope_rotation  1/s      3  change of rate_rotation
    slope_v         m/s^2    3  change of rate_v
    slope_w         rad/s^2  3  change of rate_w
""")

ESTIMATE = Record("""
    r         m      3  estimated error of a step: position of the mass centre
    rotation  rad    3  configuration, as a rotation
    v         m/s    3  velocity of the mass centre
    w         rad/s  3  angular velocity
""")

ROW = Record("""
    phi         m or 1               Phi(q, t)
    D           1 or m           12  Jacobian; columns v_a, w_a, v_b, w_b
    nu          m/s                  -Phi_t: D v = nu
    gamma       m/s^2                -D_dot v - Phi_tt: D v_dot = gamma
    right       m, m/s or m/s^2      Phi, D v - nu or gamma - D M^-1 g: what lambda must answer for
    multiplier  N or N m             lambda of the last drift
    before      N or N m             lambda of the closing kick before that drift
    trial       N or N m             lambda of the drift being tried
    delta       N or N m             its correction
    reaction    N or N m             lambda of the last closing kick, or of the sample
    scale       m or 1               scale of phi: model length, or 1 for angles
    node_a      index                first node
    node_b      index                second node
    X           1/kg             12  D M^-1
""")

COMPLIANT = Record("""
    D          1 or m              12  Jacobian; columns v_a, w_a, v_b, w_b
    G          1/s or m/s          12  derivative of D v by the position
    X          1/kg                12  D M^-1
    right      m/s                     what the correction of the multiplier must answer for
    delta      N s or N m s            that correction
    stiffness  N/m or N m/rad          rise of the force over the deformation -D q
    damping    N s/m or N m s/rad      rise of the force over its rate -D v
    node_a     index                   first node
    node_b     index                   second node
""")

TANGENTS = Record("first  index  row of a group's first entry in the table of compliant rows")
