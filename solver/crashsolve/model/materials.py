"""Materials that elements call: their laws in a group, and their columns in its tables.

A row has the constants of its material as one column, `material`, with the columns of all laws that
the group uses; `law` is the number of its own.
"""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns
from crashsolve.deck.family import FamilyError, check_arguments, constants, provided
from crashsolve.foundation.record import Column, Record
from crashsolve.materials import GeneralLaw, VonMisesLaw

if TYPE_CHECKING:
    from crashsolve.deck.reading.items import Entry
    from crashsolve.model.scene import Scene


def laws_of(entries: "list[Entry]", scene: "Scene") -> list[ModuleType]:
    """Modules of the materials of some parts, each once."""
    words = [scene.deck.entries["materials"].get(entry.card.material) for entry in entries]
    names = dict.fromkeys(w.module_name for w in words if w)
    laws = [import_module(name) for name in names]
    for law in laws:
        refuse_incomplete(law)
    return laws


def refuse_incomplete(law: ModuleType) -> None:
    """Raises FamilyError for a material that lacks a part of its Protocol."""
    kind = VonMisesLaw if law.VON_MISES else GeneralLaw
    needless = {"update", "energy"}
    if law.VON_MISES:
        needless |= {"line"} if getattr(law, "SMOOTH", False) else {"strain_of_rise"}
    elif law.FIBRE is None:
        needless |= {"fibre", "fibre_tangent"}
    wanted = {*provided(kind), *constants(kind)} - needless
    missing = sorted(name for name in wanted if not hasattr(law, name))
    if missing:
        problems = f"{kind.__name__} of materials/__init__.py"
        raise FamilyError(f"{law.__name__} must provide {', '.join(missing)}, as {problems} says")
    check_arguments(law, {n: getattr(kind, n) for n in provided(kind) if n in wanted})


def with_constants(record: Record, laws: list[ModuleType]) -> "np.dtype[np.void]":
    """Columns of a part, and the constants of its material as one."""
    own = joined([law.PARAMETERS for law in laws])
    return np.dtype([*record.dtype.descr, ("material", own.dtype.descr)])


def with_memory(record: Record, laws: list[ModuleType], count: int) -> Record:
    """Columns of a part of fibres, and the history of so many of them."""
    columns = joined([law.FIBRE for law in laws]).columns
    return record + Record(columns=tuple(column._replace(size=count) for column in columns))


def joined(records: list[Record]) -> Record:
    """Columns of several laws; those of one name are one. Raises ValueError where they differ."""
    columns: dict[str, Column] = {}
    for column in (column for record in records for column in record.columns):
        known = columns.setdefault(column.name, column)
        if (known.unit, known.size) != (column.unit, column.size):
            units = f"{known.unit} of one material, {column.unit} of another"
            raise ValueError(f"column '{column.name}' is in {units}")
    return Record(columns=tuple(columns.values()))


def fill(record: np.void, values: Columns) -> None:
    """Write values into a record; an unknown or a missing column is a programming error."""
    for name, value in values.items():
        if isinstance(value, dict):
            fill(record[name], value)
        else:
            record[name] = value


def refuse_different(
    module: ModuleType, record: Record, values: Columns, later: tuple[str, ...] = ()
) -> None:
    """Raises FamilyError unless the columns that `build` of a law returned fit its PARAMETERS.

    A missing column would be 0 without a message; `later` are those filled elsewhere.
    """
    if not isinstance(values, dict):
        raise FamilyError(f"{module.__name__}: build must return a dict of columns, not {values!r}")
    sizes = {column.name: column.size for column in record.columns}
    problems = [f"nothing for '{n}' of PARAMETERS" for n in sizes if n not in {*values, *later}]
    problems += [f"'{n}', which PARAMETERS has not" for n in values if n not in sizes]
    for name, size in sizes.items():
        numbers = np.asarray(values.get(name, np.zeros(size)))
        if numbers.size != size or numbers.dtype.kind not in "biuf":
            problems.append(
                f"{values[name]!r} for '{name}', which has {size} number{'s' * (size > 1)}"
            )
    if problems:
        raise FamilyError(f"{module.__name__}: build returns {'; '.join(problems)}")
