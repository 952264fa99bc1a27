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
    "plastic": ("begins to yield", "begin to yield"),
    "plastic_angle": ("begins to yield", "begin to yield"),
    "plastic_strain": ("begins to yield", "begin to yield"),
    "failed": ("fails", "fail"),
    "deleted": ("loses its first element", "lose their first elements"),
}
# of a kind in one sample: more of them are one event
MAX_ALIKE = 2
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
    """At most MAX_EVENTS by time, those of contacts first; the last one counts what is left out.

    `units` are those to show SI units in, such as {"N": "kN"}; fitting ones where it has none.
    """
    units = units or {}
    if not len(result.time):
        return []
    collected, started = list[Event](), list[Event]()
    for family in result.families.values():
        if family.word == "rcforc":
            collected += _of_contacts(result, family, units)
        for column in family.columns:
            if column.name in STARTS:
                started += _starts(result, family, column)
    deleted = result.status.get("deleted") or {}
    for part, entry in deleted.items() if isinstance(deleted, dict) else ():
        if isinstance(entry, dict) and isinstance(entry.get("last"), int | float):
            collected.append(
                Event(entry["last"], f"{_name(part)} has lost {entry.get('count')} elements")
            )
    return _listed(sorted(collected), sorted(started))


def _listed(collected: list[Event], started: list[Event]) -> list[Event]:
    """Events by time, where there are too many with the first starts alone."""
    surplus = len(collected) + len(started) - MAX_EVENTS
    if surplus <= 0:
        return sorted(collected + started)
    # a line for the count
    fitting = max(len(started) - surplus - 1, 0)
    kept = sorted(collected + started[:fitting])[: MAX_EVENTS - 1]
    left_out = len(collected) + len(started) - len(kept)
    return [*kept, Event(kept[-1].time, f"{left_out} more events are not listed here")]


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
    one, several = STARTS[column.name]
    # a condition that holds from the start is no event
    for row in np.unique(started[started > 0]):
        names = [_name(family.ids[k]) for k in np.flatnonzero(started == row)]
        time = float(result.time[row])
        if len(names) <= MAX_ALIKE:
            yield from (Event(time, f"{name} {one}") for name in names)
        else:
            yield Event(time, f"{names[0]} and {len(names) - 1} others {several}")


def _name(entity: str) -> str:
    return words.capital(str(entity).replace("_", " "))
