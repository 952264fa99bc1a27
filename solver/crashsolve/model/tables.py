"""Tables of a group in the composed step."""

from typing import ClassVar, Protocol

import numpy as np


class Grouped(Protocol):
    """A group of the entries of a type, or of contact pairs."""

    TABLES: ClassVar[tuple[str, ...]]


def present_tables(group: Grouped) -> dict[str, np.ndarray]:
    """Arrays of a group by the names of its TABLES; a tuple of arrays is counted from 0."""
    tables: dict[str, np.ndarray] = {}
    for name in group.TABLES:
        value = getattr(group, name)
        if isinstance(value, tuple):
            tables |= {f"{name}_{k}": array for k, array in enumerate(value)}
        elif value is not None:
            tables[name] = value
    return tables
