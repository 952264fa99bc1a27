"""Records of a contact pair and of a contact card, beside the columns of the laws of the pair."""

from crashsolve.foundation.record import Record

PARAMETERS = Record("""
    a            index  element on side a
    b            index  element on side b
    card         index  contact card
    order        count  +1 when a is on side a of the card, -1 when on side b
    speed_floor  m/s    closing speed below which a touch counts as resting
    thick        m      half thickness of both sides where they are thinnest; infinite with a plane
    spread_a     m      extent of the element on side a beyond its thickness
    spread_b     m      the same for side b
""")
# of pairs whose gap is bounded by their motion
RESTING = Record("""
    reach_a  m  extent of the element on side a from the mass centre of its body
    reach_b  m  the same for side b
""")
# of pairs whose exit is searched for in several directions (system/contact/exits.py)
EXIT_LEAD = Record("remaining_lead  m  remaining lead of the exit, after which others are searched")
# of cards that give it
TORSION = Record("torsion_radius  m  at which friction resists a spin about the normal")
# of pairs whose friction resists a spin
SPIN_RADIUS = Record("radius  m  at which it does, at the last step")
# of pairs that press over an area and whose damping is implicit (system/contact/areas.py)
PRESSURE = Record("""
    even_force  N       force of an even pressure
    gradient    N/m  3  its rise along the surface, over the force of the area
""")
HISTORY = Record("""
    active               flag     touching
    depth                m        penetration; negative is a gap
    impact_speed         m/s      closing speed at the onset
    dissipated           J        by the normal force
    power                W        its present rate
    friction_dissipated  J        by friction
    friction_power       W        its present rate
    normal_force         N     3  normal force on side a
    friction_force       N     3  friction on side a
    bristle_energy       J        recoverable energy of friction
    position             m     3  point of contact
""")
# of pairs whose sides have an end (system/contact/pass_through.py)
FACE = Record("""
    retains_face  flag  whether the pair retains its face though another is nearer
    pass_time     s     time at which one side passed the middle of the other; 0: it did not;
                        negative: by its back
""")
FACE_HISTORY = Record("normal  1  3  out of b") + FACE
OUTPUT = Record("""
    force            N  3  on side a
    point            m  3  point of contact
    stored           J     recoverable energy of the normal force
    friction_stored  J     recoverable energy of the friction bristle
    bound            m     of the depth of a pair that is skipped together with others, as their
                           `depth` (model/contact/body_pairs.py); of others 0
""")
CARD_OUTPUT = Record("""
    force                N    3  on side a, sum of all pairs
    normal               N       sum of normal forces
    tangential           N       sum of friction forces
    depth                m       deepest pair; negative is a gap, of a list of near pairs up to its
                                 margin
    impact_speed         m/s     largest of the touching pairs
    touching             1       number of touching pairs
    stored               J       recoverable energy
    dissipated           J       energy lost by the normal force
    friction_dissipated  J       energy lost by friction
""")
# sums of many pairs in pieces, which are then added to bodies and cards (model/contact/pieces.py)
LOAD = Record("""
    force            N      3  on one of the bodies of a pair
    torque           N m    3  about its mass centre
    deferred_force   N      3  part of force that began during the step
    deferred_torque  N m    3  part of torque that began during the step
    stiffness        1/s^2     sum of k times mobility, for the stable step
    damping          1/s       sum of c times mobility
    pressed          m/s^2     normal force times mobility along the slip, where friction acts
    damped           1/s       sum of c times mobility, where damping is implicit
    slip_rate        1/s       relative change of the slip per time, where friction acts
""")
COUNTS = Record("""
    deferred_force  N      3  part of the force on side a that began during the step
    onsets          count     number of onsets
    peak_share      1         largest depth over the half thicknesses of both sides
    stored          J         recoverable energy of the normal force
    bristle_energy  J         recoverable energy of friction
    work            J         of the normal force on both sides
    friction_work   J         of friction on both sides
""")
CARD_HISTORY = Record("""
    force_before              N      3  force on side a at the last step
    deferred_force            N      3  part of the force on side a that began during the step
    impulse                   N s    3  impulse on side a
    peak_normal               N         largest normal force of any step
    peak_depth                m         largest depth of any step
    peak_share                1         the same over the half thicknesses of both sides, where
                                        round sides have an end
    onsets                    count     number of onsets
    fastest                   m/s       largest impact speed of any step
    stored                    J         recoverable energy of the normal force
    bristle_energy            J         recoverable energy of friction
    work                      J         of the normal force on both sides
    friction_work             J         of friction on both sides
    initially_stored          J         stored before the first step
    largest_energy            J         largest energy stored and lost by the normal force so far
    largest_friction_energy   J         the same of friction
    exchanged                 J         sum of the sizes of the work of the normal force
    friction_exchanged        J         the same of friction
    work_rate                 W         power of the normal force on both sides, in steps of stages
    friction_work_rate        W         that of friction
    work_in_step              J         their work in the step
    friction_work_in_step     J         the same of friction
    touches                   count     times the card has begun to touch
    first_touch               s         when that was first; before the start of the run where it
                                        never was
    last_release              s         when it last ceased to touch; the same
    duration                  s         duration of contact
    in_touch                  flag      whether it touches
    begun                     s         since when
    lasted                    s         duration of contact by the last release
    deepest                   m         depth of the deepest pair
    left_dissipated           J         lost by the normal force of pairs that left the list
    left_friction_dissipated  J         lost by their friction
    left_warnings             flag      bit k: such a pair met the k-th of the WARNINGS and
                                        REMARKS of its normal law
""")
