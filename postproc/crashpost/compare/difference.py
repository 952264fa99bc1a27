"""Results side by side: how far channels differ, over the range that they have.

    difference = max |b - a| / max(range of a and b, 1e-6 of the largest of their dimension)

on the sample times of both, straight lines between them, in the time that both cover. The floor
keeps round-off, such as a momentum that should be zero, from counting as a difference.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crashpost.errors import PostError
from crashpost.figures.overlay import different_fields
from crashpost.results.choice import choices
from crashpost.results.result import Result
from crashpost.values.summary import MOMENTS
from crashsolve.channels.display import Product, factor, is_convertible
from crashsolve.channels.series import Series

# of the largest value of its dimension in the results, and in SI: less is round-off
FLOOR, NOTHING = 1e-6, 1e-12
# channels of the computation, not of the model
NUMERICS = (
    *("glstat.model.step", "glstat.model.cycle", "glstat.model.residual", "glstat.model.balance"),
    *("glstat.model.energy.imbalance", "glstat.model.momentum_error"),
    "glstat.model.angular_momentum_error",
)


@dataclass(frozen=True)
class Difference:
    """A channel of one result against that of the first: largest difference [of the scale]."""

    channel: str
    unit: str
    run: int
    sizes: tuple[float, float]  # largest magnitude in the first and in this one
    largest: float
    time: float
    rms: float

    def is_beyond(self, tolerance: float) -> bool:
        """Whether it is more than the tolerance."""
        return self.largest > tolerance


@dataclass(frozen=True)
class Compared:
    """Differences of results, the largest first, and channels that could not be compared."""

    differences: list[Difference]
    remarks: list[str]


def compare(results: Sequence[Result], requested: Sequence[str] = ()) -> Compared:
    """Every result against the first; raises PostError for fewer than two, or nothing in common."""
    if len(results) < 2:
        raise PostError("compare takes two results or more")
    differences, remarks = list[Difference](), list[str]()
    for run, other in enumerate(results[1:], start=1):
        shared, alone = _names(results[0], other, requested)
        if not shared:
            raise PostError(f"{other.folder} and {results[0].folder} share no channel")
        remarks += alone + _decks(results[0], other) + _times(results[0], other)
        floors = _floors(results[0], other, shared)
        differences += [_difference(results[0], other, run, name, floors) for name in shared]
    return Compared(sorted(differences, key=lambda one: -one.largest), remarks)


def _names(first: Result, other: Result, requested: Sequence[str]) -> tuple[list[str], list[str]]:
    """Channels of both, and a remark for those of one; raises PostError."""
    if requested:
        both = [[choice.channel for choice in choices(r, requested)] for r in (first, other)]
    else:
        both = [[c.name for c in r.channels() if _is_compared(c.name)] for r in (first, other)]
    known = [set(names) for names in both]
    remarks = []
    for at, result in enumerate((first, other)):
        only = sorted(known[at] - known[1 - at])
        if only:
            shown = ", ".join(only[:5]) + (", ..." if len(only) > 5 else "")
            word = "channel" if len(only) == 1 else "channels"
            remarks.append(f"{len(only)} {word} in {result.folder} only: {shown}")
    return [name for name in both[0] if name in known[1]], remarks


def _decks(first: Result, other: Result) -> list[str]:
    """A remark on the fields in which decks differ: what names the results may not be all."""
    try:
        fields = different_fields((first, other))
    except PostError:
        return []
    shown = ", ".join(fields[:5]) + (f" and {len(fields) - 5} more" if len(fields) > 5 else "")
    of = "field" if len(fields) == 1 else "fields"
    return [f"the decks differ in {len(fields)} {of}: {shown}"] if fields else []


def _is_compared(name: str) -> bool:
    """Whether a channel is one of the model; moments before the run stand for what has not been."""
    return name not in NUMERICS and name.rpartition(".")[2] not in MOMENTS


def _times(first: Result, other: Result) -> list[str]:
    """A remark where one run covers less time than the other."""
    if not len(first.time) or not len(other.time):
        raise PostError(f"{(other if len(first.time) else first).folder} holds no samples")
    ends = [(float(r.time[0]), float(r.time[-1])) for r in (first, other)]
    span = max(last - begin for begin, last in ends)
    if max(abs(a - b) for a, b in zip(*ends, strict=True)) <= 1e-9 * span:
        return []
    cells = [
        f"{start:g} s to {end:g} s in {folder}"
        for folder, (start, end) in zip((first.folder, other.folder), ends, strict=True)
    ]
    return [f"compared in the time of both: {' and '.join(cells)}"]


def _floors(first: Result, other: Result, names: Sequence[str]) -> dict[object, float]:
    """For each dimension the size below which differences are round-off."""
    floors: dict[object, float] = {}
    for series in (result.series(name) for name in names for result in (first, other)):
        kind, size = _dimension(series.unit)
        largest = size * float(np.max(np.abs(series.values), initial=0.0))
        floors[kind] = max(floors.get(kind, NOTHING), FLOOR * largest)
    return floors


def _dimension(unit: str) -> tuple[object, float]:
    """Dimension of a unit, and its size in SI; an unknown unit itself."""
    try:
        size = Product.parse(unit).size()
    except PostError:
        return unit, 1.0
    return size.powers, size.factor


def _difference(
    first: Result, other: Result, run: int, name: str, floors: dict[object, float]
) -> Difference:
    a, b = first.series(name), other.series(name)
    if not is_convertible(a.unit, b.unit):
        raise PostError(f"'{name}' is in '{a.unit}' and in '{b.unit}'")
    b = Series(b.time, b.values * factor(b.unit, a.unit), a.unit)
    if not (np.isfinite(a.values).all() and np.isfinite(b.values).all()):
        raise PostError(f"division by zero at some samples of '{name}'")
    time, left, right = on_common_times(a, b)
    apart = np.abs(right - left)
    both = np.concatenate([left, right])
    kind, unit = _dimension(a.unit)
    scale = max(float(np.ptp(both)), floors[kind] / unit)
    size = 1.0 / scale if scale > 0 else 0.0
    at = int(np.argmax(apart))
    sizes = float(np.max(np.abs(left))), float(np.max(np.abs(right)))
    rms = float(np.sqrt(np.mean(np.square(apart))))
    return Difference(
        name, a.unit, run, sizes, float(apart[at]) * size, float(time[at]), rms * size
    )


def on_common_times(a: Series, b: Series) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times of both within their common range, and both histories there; raises PostError."""
    start, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    if start > end:
        raise PostError("the results have no time in common")
    time = np.union1d(a.time, b.time)
    time = time[(time >= start) & (time <= end)]
    return time, np.interp(time, a.time, a.values), np.interp(time, b.time, b.values)
