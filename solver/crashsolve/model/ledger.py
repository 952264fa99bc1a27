"""The entries of the energy ledger, in the order of State.ledger.

Entries behind the imbalance are shares of others: they are told, and summed nowhere.
"""

import numpy as np

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
# a step far too long makes so many times the energy there should be, within a few steps
OUT_OF_NOTHING = 10.0


def is_broken(ledger: np.ndarray, limit: float) -> bool:
    """Whether the imbalance exceeds `limit` times the largest energy (0: never asked)."""
    return limit > 0.0 and not abs(ledger[IMBALANCE]) <= limit * ledger[LARGEST]


def is_out_of_nothing(ledger: np.ndarray, limit: float) -> bool:
    """Whether motion and laws have many times the energy that was there or came in."""
    due = ledger[INITIAL] - ledger[POTENTIAL] + ledger[EXTERNAL_WORK] + ledger[DRIVER_WORK]
    return is_broken(ledger, limit) and not ledger[IMBALANCE] <= OUT_OF_NOTHING * abs(due)
