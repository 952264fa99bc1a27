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
) = range(10)

CLOCK = Record(
    time=("s", "present time"),
    step=("s", "last step taken"),
    next_step=("s", "step wanted by stability and accuracy"),
    goal=("s", "time on which a step must end; samples before it may lie within steps"),
    sampled=("s", "time of the last sample"),
    cycle=("count", "accepted steps"),
    current=("index", "which of the two history buffers is accepted"),
    lead=("s", "weight of the step's start in sums over the step"),
    share=("s", "weight of the present force pass in them"),
    stage=("index", "stage of a Runge-Kutta step that the present force pass belongs to"),
    opens=("flag", "whether that is the first pass of the step"),
    closes=("flag", "whether it is the last"),
    status=("flag", "why the loop stopped"),
    place=("index", "row, node or curve the status is about"),
    value=("1", "number the status is about"),
    iterations=("count", "of positions, and passes over implicit stages"),
    kinked=("flag", "whether the last step ended where a contact begins or ends"),
    passes=("count", "passes of the last iteration for implicit stages"),
    rejected=("count", "attempts at a step that were too long"),
    fastest=("m/s", "largest speed so far, to which the error of a step is compared"),
    located=("count", "onsets, ends of contacts and corners of laws located"),
    residual=("1", "largest position residual over model size so far"),
    rate_residual=("1/s", "largest velocity residual over model size so far"),
    limit_node=("index", "node that sets the step; below 0: an element"),
    driver_work=("J", "work of prescribed motions"),
    driver_power=("W", "its present rate"),
    impulse=("N s", 3, "impulse from outside"),
    angular_impulse=("N m s", 3, "angular impulse from outside about the world origin"),
    external_before=("N", 6, "force and torque from outside at the step's start"),
    element_rate=("1/s^2", "largest squared frequency of an element"),
    limit_element=("index", "the element that has it"),
)

CONTROL = Record(
    fixed_step=("s", "step asked for by the deck; 0 for automatic"),
    step_min=("s", "a smaller step stops the run"),
    step_max=("s", "largest step"),
    safety=("1", "automatic step over the stability limit"),
    turn=("rad", "largest turn of a body in an automatic step"),
    constraint_tolerance=("1", "largest position residual over model size"),
    onset_tolerance=("m", "first penetration taken as it falls; 0 to locate every onset"),
    energy_limit=("1", "imbalance over largest energy that stops the run; 0 for none"),
    spectral_radius=("1", "of generalized-alpha at infinite frequency"),
    tolerance=("1", "error of a step over the model's size and largest speed"),
    length=("m", "the model's size"),
    end=("s", "time at which the run ends"),
    check_every=("count", "cycles between guards"),
)
