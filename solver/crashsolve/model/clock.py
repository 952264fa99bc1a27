"""Time, step and running totals of a run: the scalar part of the State."""

from crashsolve.foundation.record import Record

# why the compiled loop gave control back
(
    RUNNING,
    REACHED,
    NOT_FINITE,
    POSITION,
    STEP_TOO_SMALL,
    CURVE_END,
    ENERGY,
    REBUILD,
    ONSET,
    STOPPED,
    VELOCITY,
    UNSOLVED,
    PAUSED,
    UNHELD,
    ROTATED,
    CONTACT_GAIN,
    TOUCHED,
    LAW_GAIN,
) = range(18)
# those that a sample can find, which end a run
STOPS_AT_SAMPLE = (NOT_FINITE, ENERGY, CONTACT_GAIN, LAW_GAIN, POSITION)

# of `kinked`: at a corner of a curve of time, which the next step begins behind
CORNER = 2

CLOCK = Record("""
    time             s         present time
    step             s         last step taken
    loads_at_start   W/s       f . M^-1 f of all loads at the start of the run
    kicked_over      s         length of the last step that was not a sample
    next_step        s         step wanted by stability and accuracy
    goal             s         time on which a step must end; samples before it may lie within steps
    sampled          s         time of the last sample
    cycle            count     accepted steps
    pause            count     cycle at which the loop gives control back; 0 outside of it
    current          index     which of the two history buffers is accepted
    lead             s         weight of the step's start in sums over the step
    share            s         weight of the present force pass in them
    stage            index     stage of a Runge-Kutta step that the present force pass belongs to
    opens            flag      whether that is the first pass of the step
    closes           flag      whether it is the last
    ends             flag      whether it is at the end of the step, where contacts begin
    status           flag      why the loop stopped
    fault            flag      why the last attempt at a step failed, as a status
    index            index     row, node or curve that the status concerns
    value            1         number the status is about
    iterations       count     of positions, and passes over implicit stages
    kinked           flag      whether the last step ended where a contact begins or ends, or 2: at
                               a CORNER
    last_iterations  count     iterations of the last drift, or of the last implicit stage
    factored         s         step of the factors of an implicit method, or at the end of which
                               an explicit one has factored the constraints; 0: out of date
    rejected         count     attempts at a step that were too long
    fastest          m/s       largest speed so far, to which the error of a step is compared
    error            1         estimated error of the last step over size and speed
    located          count     onsets, ends of contacts and corners of laws located
    residual         1         largest position residual over model size so far
    rate_residual    1/s       largest velocity residual over model size so far
    limit_node       index     node that sets the step; below 0: an element
    driver_work      J         work of prescribed motions
    largest_work     J         largest work from outside after a step so far
    lack             1         imbalance over largest energy at the last check
    missing          J         largest imbalance at a check where it was above the limit
    missing_share    1         the same over the largest energy by then
    missing_time     s         when that was
    impulse          N s    3  impulse from outside
    angular_impulse  N m s  3  angular impulse from outside about the world origin
    load_factor      1         along a path of equilibria: 0 at the start, 1 at end_time
    unstable_modes   count     of the equilibrium there
    kick             N s    6  impulse and its moment that closed the joints at the end of the last
                               step
    element_rate     1/s^2     bound of the squared frequencies of the elements, then of the mesh
    limit_element    index     the element that has it
    swing            1         largest frequency of a body times a stated step of rattle so far
    swing_node       index     the body
    swing_square     1/s^2     its stiffness over its mass then
    swing_damping    1/s       and its damping
""")

CONTROL = Record("""
    fixed_step            s      step given by the deck; 0 for automatic
    step_min              s      a smaller step stops the run
    step_max              s      largest step
    curve_step            s      largest automatic step in which curves of time are seen, at present
    least_speed           m/s    that errors of steps are compared to at least, once bodies move
    curve_share           1      by which that is lengthened or shortened
    safety                1      automatic step over the stability limit
    rotation              rad    largest rotation of a body in an automatic step
    constraint_tolerance  1      largest position residual over model size
    onset_tolerance       m      first penetration taken as it falls; 0 to locate every onset
    energy_limit          1      imbalance over largest energy that stops the run; 0 for none
    spectral_radius       1      of generalized-alpha at infinite frequency
    tolerance             1      error of a step over the model's size and largest speed
    length                m      the model's size
    thinnest              m      least half thickness of two sides of contacts
    start                 s      time at which the run begins
    end                   s      time at which it ends
    check_every           count  cycles between guards
    searches              flag   whether corrections of Newton's method from rest are shortened
    follows_path          flag   whether equilibria are followed through limit points
    gaps                  flag   whether samples need the gaps of contacts that do not touch
    resolves              flag   whether steps chosen by their error keep to safety and rotation
""")
