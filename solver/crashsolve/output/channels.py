"""Families of channels of a history: entities with the same columns.

A channel is one entity's one column and is named family.id.quantity.component; the component is
left out for a scalar. Families carry the names crash engineers know from LS-DYNA's binout.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from crashsolve.deck.family import families

FAMILIES = {"glstat": "energies, momenta and time step of the whole model"}
for _family in families().values():
    FAMILIES |= _family.channels or {}


class Column(NamedTuple):
    """One quantity of every entity of a family; `component` is empty for a scalar."""

    quantity: str
    component: str
    unit: str
    meaning: str

    @property
    def path(self) -> str:
        """Name of the dataset inside the family's group."""
        return f"{self.quantity}/{self.component}" if self.component else self.quantity


@dataclass(frozen=True)
class Family:
    """Entities (`ids`) sampled in the same columns; raises ValueError for unusable names.

    Types of a family that differ in columns stand side by side, named `deforc-linear`,
    `deforc-torsional`; their channels all begin with `deforc`.
    """

    name: str
    ids: tuple[str, ...]
    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
        if self.word not in FAMILIES:
            raise ValueError(f"unknown family '{self.name}'; one of {', '.join(FAMILIES)}")
        paths = [column.path for column in self.columns]
        words = [*self.ids, *(column.quantity for column in self.columns)]
        words += [column.component for column in self.columns if column.component]
        for word in words:
            if not word or "." in word or "/" in word:
                raise ValueError(f"family '{self.name}': unusable name '{word}'")
        groups = [column.quantity for column in self.columns if column.component]
        for names in (self.ids, ["time", "ids", *paths], [*set(groups), *paths]):
            twice = [name for name, count in Counter(names).items() if count > 1]
            if twice:
                raise ValueError(f"family '{self.name}': name '{twice[0]}' used twice")

    @property
    def word(self) -> str:
        """First word of the family's channels."""
        return self.name.partition("-")[0]

    def channel(self, entity: int, column: int) -> str:
        """Channel name of one column of one entity."""
        dotted = self.columns[column].path.replace("/", ".")
        return f"{self.word}.{self.ids[entity]}.{dotted}"

    def channels(self) -> Iterator[str]:
        """All channel names, entity by entity."""
        for entity in range(len(self.ids)):
            for column in range(len(self.columns)):
                yield self.channel(entity, column)
