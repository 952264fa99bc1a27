"""The entries of the energy ledger, in the order of State.ledger.

From kinetic to friction they are added up. `internal` is the sum of two of them: told, not added.
"""

from typing import Any

import numpy as np

from crashsolve.deck.family import families

# words whose entries are told otherwise than NAME_stored and NAME_dissipated
OTHERWISE: dict[str, tuple[str, str | None]] = {
    "external": ("potential", "external_work"),
    "potential": ("potential", None),
    "part": ("elastic", "part_damping"),
}
# words under which laws of families book what they store and lose, in the order of the ledger
WORDS = tuple(
    dict.fromkeys(w for family in families().values() for w in family.energy if w not in OTHERWISE)
)
ENTRIES = (
    "kinetic",
    "potential",
    "elastic",
    "hourglass",
    "drilling",
    "plastic",
    "part_damping",
    "eroded",
    *(f"{word}_{end}" for word in WORDS for end in ("stored", "dissipated")),
    "external_work",
    "driver_work",
    "initial",
    "largest",
    "imbalance",
    "internal",
)
PLACE = {name: k for k, name in enumerate(ENTRIES)}
KINETIC, POTENTIAL = PLACE["kinetic"], PLACE["potential"]
ELASTIC, HOURGLASS, DRILLING = PLACE["elastic"], PLACE["hourglass"], PLACE["drilling"]
PLASTIC, PART_DAMPING, ERODED = PLACE["plastic"], PLACE["part_damping"], PLACE["eroded"]
CONTACT_STORED, CONTACT_DISSIPATED = PLACE["contact_stored"], PLACE["contact_dissipated"]
FRICTION_STORED, FRICTION_DISSIPATED = PLACE["friction_stored"], PLACE["friction_dissipated"]
EXTERNAL_WORK, DRIVER_WORK = PLACE["external_work"], PLACE["driver_work"]
INITIAL, LARGEST, IMBALANCE = PLACE["initial"], PLACE["largest"], PLACE["imbalance"]
INTERNAL = PLACE["internal"]
# what can be had back: the energy at the start is the sum of these
MECHANICAL = (
    KINETIC,
    POTENTIAL,
    ELASTIC,
    HOURGLASS,
    DRILLING,
    *(PLACE[f"{word}_stored"] for word in WORDS),
)
# a step far too long makes so many times the energy there should be, within a few steps
OUT_OF_NOTHING = 10.0


def entries_of(group: Any) -> tuple[int, int | None]:
    """Places of what the laws of a group store, and of what they lose.

    A law may name another word of its family (LEDGER) than the first. Raises: KeyError for a word
    that the family does not declare.
    """
    words = families()[group.keyword].energy
    word = getattr(group.module, "LEDGER", words[0])
    if word not in words:
        raise KeyError(f"LEDGER of {group.module.__name__} must be one of {', '.join(words)}")
    stored, lost = OTHERWISE.get(word, (f"{word}_stored", f"{word}_dissipated"))
    return PLACE[stored], None if lost is None else PLACE[lost]


def is_broken(ledger: np.ndarray, limit: float) -> bool:
    """Whether the imbalance exceeds `limit` times the largest energy (0: never asked)."""
    return limit > 0.0 and not abs(ledger[IMBALANCE]) <= limit * ledger[LARGEST]


def is_out_of_nothing(ledger: np.ndarray, limit: float) -> bool:
    """Whether motion and laws have many times the energy that was there or came in."""
    due = ledger[INITIAL] - ledger[POTENTIAL] + ledger[EXTERNAL_WORK] + ledger[DRIVER_WORK]
    return is_broken(ledger, limit) and not ledger[IMBALANCE] <= OUT_OF_NOTHING * abs(due)
