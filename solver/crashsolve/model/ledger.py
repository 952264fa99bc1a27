"""The entries of the energy ledger, in the order of State.ledger.

From kinetic to friction they are added up. `internal` is the sum of two of them: reported, not
added.
"""

from types import ModuleType
from typing import Protocol

import numpy as np

from crashsolve.deck.family import families
from crashsolve.foundation.kernels import kernel

# words whose entries are reported otherwise than NAME_stored and NAME_dissipated
OTHERWISE: dict[str, tuple[str, str | None]] = {
    "external": ("potential", "external_work"),
    "potential": ("potential", None),
    "part": ("elastic", "part_damping"),
}
# entries of stored and dissipated energies of families, in the order of the ledger
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
INDEX = {name: k for k, name in enumerate(ENTRIES)}
KINETIC, POTENTIAL = INDEX["kinetic"], INDEX["potential"]
ELASTIC, HOURGLASS, DRILLING = INDEX["elastic"], INDEX["hourglass"], INDEX["drilling"]
PLASTIC, PART_DAMPING, ERODED = INDEX["plastic"], INDEX["part_damping"], INDEX["eroded"]
CONTACT_STORED, CONTACT_DISSIPATED = INDEX["contact_stored"], INDEX["contact_dissipated"]
FRICTION_STORED, FRICTION_DISSIPATED = INDEX["friction_stored"], INDEX["friction_dissipated"]
EXTERNAL_WORK, DRIVER_WORK = INDEX["external_work"], INDEX["driver_work"]
INITIAL, LARGEST, IMBALANCE = INDEX["initial"], INDEX["largest"], INDEX["imbalance"]
INTERNAL = INDEX["internal"]
# recoverable: the energy at the start is the sum of these
MECHANICAL = (
    KINETIC,
    POTENTIAL,
    ELASTIC,
    HOURGLASS,
    DRILLING,
    *(INDEX[f"{word}_stored"] for word in WORDS),
)
# a step far too long makes so many times the energy there should be, within a few steps
SPURIOUS = 10.0


class Grouped(Protocol):
    """A group of the entries of a family (model/model.py)."""

    keyword: str
    module: ModuleType


def entries_of(group: Grouped) -> tuple[int, int | None]:
    """Entries of the energy that the laws of a group store, and of their losses.

    A law may name another word of its family (LEDGER) than the first. Raises: KeyError for a word
    that the family does not declare.
    """
    words = families()[group.keyword].energy
    word = getattr(group.module, "LEDGER", words[0])
    if word not in words:
        raise KeyError(f"LEDGER of {group.module.__name__} must be one of {', '.join(words)}")
    stored, lost = OTHERWISE.get(word, (f"{word}_stored", f"{word}_dissipated"))
    return INDEX[stored], None if lost is None else INDEX[lost]


@kernel
def is_broken(ledger: np.ndarray, limit: float) -> bool:
    """Whether the imbalance exceeds `limit` times the largest energy (0: never)."""
    return limit > 0.0 and not abs(ledger[IMBALANCE]) <= limit * ledger[LARGEST]


@kernel
def is_spurious_energy(ledger: np.ndarray, limit: float) -> bool:
    """Whether motion and laws have many times the energy that was there or came in."""
    due = ledger[INITIAL] - ledger[POTENTIAL] + ledger[EXTERNAL_WORK] + ledger[DRIVER_WORK]
    return is_broken(ledger, limit) and not ledger[IMBALANCE] <= SPURIOUS * abs(due)
