"""What happened, in the order in which it did: contacts, forces, yield, failure, deletion."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from crashpost.results.result import Column, Family, Result
from crashpost.results.table import number
from crashpost.values import words
from crashsolve.channels.display import factor, readable

MAX_EVENTS = 40
# quantities of which the first sample that is not zero is an event, and how it is reported
STARTS = {
    "plastic": "begins to yield",
    "plastic_angle": "begins to yield",
    "plastic_strain": "begins to yield",
    "failed": "fails",
    "deleted": "loses its first element",
}
# share of the largest force of all steps that a sample must show to be called its time
SHOWN = 0.999
# [of the largest value] less is round-off
LEAST = 1e-9
# [of a touch] a force that ends so much before its surfaces part is reported by itself
EARLY_END = 0.05


class Event(NamedTuple):
    """Something that happened at a time [s]."""

    time: float
    text: str


def events(result: Result, units: Mapping[str, str] | None = None) -> list[Event]:
    """All of them by time; of contacts and starts at most MAX_EVENTS.

    `units` are those to show SI units in, such as {"N": "kN"}; fitting ones where it has none.
    """
    units = units or {}
    if not len(result.time):
        return []
    collected: list[Event] = []
    for family in result.families.values():
        if family.word == "rcforc":
            collected += _of_contacts(result, family, units)
        for column in family.columns:
            if column.name in STARTS:
                collected += _starts(result, family, column)
    deleted = result.status.get("deleted") or {}
    for part, entry in deleted.items() if isinstance(deleted, dict) else ():
        if isinstance(entry, dict) and isinstance(entry.get("last"), int | float):
            collected.append(
                Event(entry["last"], f"{_name(part)} has lost {entry.get('count')} elements")
            )
    return sorted(collected)[:MAX_EVENTS]


def _of_contacts(result: Result, family: Family, units: Mapping[str, str]) -> Iterator[Event]:
    """First touch, largest force and last release of every contact that touches."""
    start, end = float(result.time[0]), float(result.time[-1])
    before = start - 1.0
    columns = {column.name: column for column in family.columns}
    peaks = _peaks(result, family, columns, units.get("s", "s"))
    ends = _force_ends(result, family, columns.get("normal"))
    touches, releases = (
        result.last(family, columns[name]) if name in columns else np.full(len(family.ids), before)
        for name in ("first_touch", "last_release")
    )
    for at, entity in enumerate(family.ids):
        touch, release = float(touches[at]), float(releases[at])
        if touch >= start:
            yield Event(touch, f"{_name(entity)}: first contact")
        if peaks is not None and peaks[at][0] > 0:
            force, top, where = peaks[at]
            unit = units.get("N") or readable("N", force)
            entry = f"{number(force * factor('N', unit))} {unit}{where}"
            yield Event(top, f"{_name(entity)}: largest contact force, {entry}")
        if touch >= start and touch < release < end:
            # surfaces may stay together, or part late, where no force is left between them
            ended = float(ends[at])
            if ended < release - EARLY_END * (release - touch):
                yield Event(ended, f"{_name(entity)}: the force has ended")
                yield Event(release, f"{_name(entity)}: the surfaces separate")
            else:
                yield Event(release, f"{_name(entity)}: last release")


def _peaks(
    result: Result, family: Family, columns: dict[str, Column], time_unit: str
) -> list[tuple[float, float, str]] | None:
    """Largest force of each contact over all steps [N], its time [s], and the accuracy of that [s].

    Between two samples it is known to their interval, and has the time of the later one.
    """
    if "normal" not in columns:
        return None
    sampled = result.extremes(family, columns["normal"])
    peaks = [
        (float(force), float(result.time[row]), "")
        for force, row in zip(sampled.greatest, sampled.greatest_row, strict=True)
    ]
    if "peak_normal" not in columns:
        return peaks
    of_steps = result.extremes(family, columns["peak_normal"])
    for at, (peak, row) in enumerate(zip(of_steps.greatest, of_steps.greatest_row, strict=True)):
        if peaks[at][0] < SHOWN * peak:
            before = float(result.time[max(int(row) - 1, 0)]) * factor("s", time_unit)
            begin = f"{number(before)} {time_unit}"
            where = f" (within the interval of samples that begins at {begin})"
            peaks[at] = float(peak), float(result.time[row]), where
    return peaks


def _force_ends(result: Result, family: Family, column: Column | None) -> np.ndarray:
    """Times (n_id,) of the first samples without force after the last with one; never: inf."""
    times = np.full(len(family.ids), np.inf)
    if column is None:
        return times
    largest = result.extremes(family, column).largest
    for first, values in result.slabs(family, column):
        for at in range(len(family.ids)):
            rows = np.flatnonzero(np.abs(values[:, at]) > LEAST * largest[at])
            if len(rows):
                after = first + int(rows[-1]) + 1
                times[at] = result.time[after] if after < len(result.time) else np.inf
    return times


def _starts(result: Result, family: Family, column: Column) -> Iterator[Event]:
    largest = result.extremes(family, column).largest
    started = np.full(len(family.ids), -1)
    for first, values in result.slabs(family, column):
        moved = np.abs(values) > LEAST * largest
        new = (started < 0) & moved.any(axis=0)
        started[new] = first + moved.argmax(axis=0)[new]
    for entity, row in zip(family.ids, started, strict=True):
        # a condition that holds from the start is no event
        if row > 0:
            yield Event(float(result.time[row]), f"{_name(entity)} {STARTS[column.name]}")


def _name(entity: str) -> str:
    return words.capital(str(entity).replace("_", " "))
