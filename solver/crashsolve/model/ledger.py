"""The entries of the energy ledger, in the order of State.ledger.

From kinetic to friction they are added up. `internal` is the sum of two of them: told, not added.
"""

from typing import Any

import numpy as np

ENTRIES = (
    "kinetic",
    "potential",
    "elastic",
    "hourglass",
    "drilling",
    "plastic",
    "part_damping",
    "eroded",
    "spring_stored",
    "spring_dissipated",
    "hinge_stored",
    "hinge_dissipated",
    "joint_stored",
    "joint_dissipated",
    "brake_stored",
    "brake_dissipated",
    "contact_stored",
    "contact_dissipated",
    "friction_stored",
    "friction_dissipated",
    "external_work",
    "driver_work",
    "initial",
    "largest",
    "imbalance",
    "internal",
)
(
    KINETIC,
    POTENTIAL,
    ELASTIC,
    HOURGLASS,
    DRILLING,
    PLASTIC,
    PART_DAMPING,
    ERODED,
    SPRING_STORED,
    SPRING_DISSIPATED,
    HINGE_STORED,
    HINGE_DISSIPATED,
    JOINT_STORED,
    JOINT_DISSIPATED,
    BRAKE_STORED,
    BRAKE_DISSIPATED,
    CONTACT_STORED,
    CONTACT_DISSIPATED,
    FRICTION_STORED,
    FRICTION_DISSIPATED,
    EXTERNAL_WORK,
    DRIVER_WORK,
    INITIAL,
    LARGEST,
    IMBALANCE,
    INTERNAL,
) = range(len(ENTRIES))
# what can be had back: the energy at the start is the sum of these
MECHANICAL = (
    KINETIC,
    POTENTIAL,
    ELASTIC,
    HOURGLASS,
    DRILLING,
    SPRING_STORED,
    HINGE_STORED,
    JOINT_STORED,
    BRAKE_STORED,
    CONTACT_STORED,
    FRICTION_STORED,
)
# places of what laws store and of what they lose, by the word LEDGER of their module
BOOKED: dict[str, tuple[int, int | None]] = {
    "spring": (SPRING_STORED, SPRING_DISSIPATED),
    "hinge": (HINGE_STORED, HINGE_DISSIPATED),
    "joint": (JOINT_STORED, JOINT_DISSIPATED),
    "brake": (BRAKE_STORED, BRAKE_DISSIPATED),
    "external": (POTENTIAL, EXTERNAL_WORK),
    "potential": (POTENTIAL, None),
    "part": (ELASTIC, PART_DAMPING),
}
KINDS = {"loads": "external", "parts": "part"}
# a step far too long makes so many times the energy there should be, within a few steps
OUT_OF_NOTHING = 10.0


def entries_of(group: Any) -> tuple[int, int | None]:
    """Places of what the laws of a group store, and of what they lose."""
    return BOOKED[getattr(group.module, "LEDGER", KINDS.get(group.keyword, "spring"))]


def is_broken(ledger: np.ndarray, limit: float) -> bool:
    """Whether the imbalance exceeds `limit` times the largest energy (0: never asked)."""
    return limit > 0.0 and not abs(ledger[IMBALANCE]) <= limit * ledger[LARGEST]


def is_out_of_nothing(ledger: np.ndarray, limit: float) -> bool:
    """Whether motion and laws have many times the energy that was there or came in."""
    due = ledger[INITIAL] - ledger[POTENTIAL] + ledger[EXTERNAL_WORK] + ledger[DRIVER_WORK]
    return is_broken(ledger, limit) and not ledger[IMBALANCE] <= OUT_OF_NOTHING * abs(due)
