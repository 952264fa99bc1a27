"""The entries of the energy ledger, in the order of State.ledger.

Entries behind the imbalance are shares of others: they are told, and summed nowhere.
"""

ENTRIES = (
    "kinetic",
    "potential",
    "spring_stored",
    "spring_dissipated",
    "contact_stored",
    "contact_dissipated",
    "friction_stored",
    "friction_dissipated",
    "joint_friction",
    "brake",
    "external_work",
    "driver_work",
    "initial",
    "largest",
    "imbalance",
    "part_damping",
)
(
    KINETIC,
    POTENTIAL,
    SPRING_STORED,
    SPRING_DISSIPATED,
    CONTACT_STORED,
    CONTACT_DISSIPATED,
    FRICTION_STORED,
    FRICTION_DISSIPATED,
    JOINT_FRICTION,
    BRAKE,
    EXTERNAL_WORK,
    DRIVER_WORK,
    INITIAL,
    LARGEST,
    IMBALANCE,
    PART_DAMPING,
) = range(len(ENTRIES))
# what the energy at the start is the sum of
STORED = (KINETIC, POTENTIAL, SPRING_STORED, CONTACT_STORED, FRICTION_STORED)
