"""What happened, in the order in which it did: contacts, forces, yield, failure, deletion."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from crashpost.results.result import Column, Family, Result
from crashpost.results.table import number
from crashpost.values import words
from crashsolve.channels.display import factor, readable

MOST = 40
# quantities of which the first sample that is not zero is an event, and how it is told
STARTS = {
    "plastic": "begins to yield",
    "plastic_angle": "begins to yield",
    "plastic_strain": "begins to yield",
    "failed": "fails",
    "deleted": "loses its first element",
}
# [of the largest value] less is round-off
LEAST = 1e-9


class Event(NamedTuple):
    """Something that happened at a time [s]."""

    time: float
    text: str


def events(result: Result) -> list[Event]:
    """All of them by time; of contacts and starts at most MOST."""
    if not len(result.time):
        return []
    found: list[Event] = []
    for family in result.families.values():
        if family.word == "rcforc":
            found += _of_contacts(result, family)
        for column in family.columns:
            if column.name in STARTS:
                found += _starts(result, family, column)
    deleted = result.status.get("deleted") or {}
    for part, told in deleted.items() if isinstance(deleted, dict) else ():
        if isinstance(told, dict) and isinstance(told.get("last"), int | float):
            found.append(
                Event(told["last"], f"{_name(part)} has lost {told.get('count')} elements")
            )
    return sorted(found)[:MOST]


def _of_contacts(result: Result, family: Family) -> Iterator[Event]:
    """First touch, largest force and last release of every contact that touches."""
    start, end = float(result.time[0]), float(result.time[-1])
    wanted = ("normal", "first_touch", "last_release")
    columns = {c.name: result.block(family, c) for c in family.columns if c.name in wanted}
    normal = columns.get("normal")
    for at, entity in enumerate(family.ids):
        touch, release = (
            float(columns[name][-1, at]) if name in columns else start - 1.0
            for name in ("first_touch", "last_release")
        )
        if touch >= start:
            yield Event(touch, f"{_name(entity)}: first contact")
        if normal is not None and np.max(normal[:, at]) > 0:
            top = int(np.argmax(normal[:, at]))
            force = float(normal[top, at])
            unit = readable("N", force)
            told = f"{number(force * factor('N', unit))} {unit}"
            yield Event(float(result.time[top]), f"{_name(entity)}: largest contact force, {told}")
        if touch >= start and touch < release < end:
            yield Event(release, f"{_name(entity)}: last release")


def _starts(result: Result, family: Family, column: Column) -> Iterator[Event]:
    values = np.abs(result.block(family, column))
    for at, entity in enumerate(family.ids):
        begun = np.flatnonzero(values[:, at] > LEAST * np.max(values[:, at]))
        # what has been so from the start has not happened
        if len(begun) and begun[0] > 0:
            text = f"{_name(entity)} {STARTS[column.name]}"
            yield Event(float(result.time[begun[0]]), text)


def _name(entity: str) -> str:
    return words.capital(str(entity).replace("_", " "))
