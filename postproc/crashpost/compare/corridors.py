"""Whether a history stays in the corridor of a test, for how long, and how far it leaves it.

    excess = max(lower - y, y - upper),   straight lines between samples and between borders' points

in the time that history and both borders cover. The share of time inside is that with an excess of
0 or less, its ends found on the straight lines.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crashpost.errors import PostError
from crashpost.results.choice import choices
from crashpost.results.result import Result
from crashpost.results.table import number
from crashpost.values.measured import read_test
from crashsolve.channels.display import factor, is_convertible
from crashsolve.channels.series import Window

Polyline = tuple[np.ndarray, np.ndarray]
HEADER = ("result", "channel", "test", "time inside", "largest excess", "unit", "at s")


@dataclass(frozen=True)
class CorridorResult:
    """Share of the time inside, and the largest excess, 0 for one that never leaves, with when."""

    inside: float
    excess: float
    at: float


def compare_with_corridor(
    history: Polyline, lower: Polyline, upper: Polyline, during: Window | None = None
) -> CorridorResult:
    """Share of time and excess of a history (x, y) with borders (x, y); raises PostError without
    common time.
    """
    histories = history, lower, upper
    first, last = during or (-np.inf, np.inf)
    first = max(first, *(float(x[0]) for x, _ in histories))
    last = min(last, *(float(x[-1]) for x, _ in histories))
    if not first < last:
        raise PostError("history and corridor have no time in common")
    inner = np.concatenate([x[(x > first) & (x < last)] for x, _ in histories])
    time = np.unique(np.concatenate([[first], inner, [last]]))
    y, low, high = (np.interp(time, *x_and_y) for x_and_y in histories)
    excess = np.maximum(low - y, y - high)
    a, b, steps = excess[:-1], excess[1:], np.diff(time)
    below, above = np.minimum(a, b), np.maximum(a, b)
    crosses = (below < 0.0) & (above > 0.0)
    share = np.where(crosses, -below / np.where(crosses, above - below, 1.0), above <= 0.0)
    worst = int(np.argmax(excess))
    return CorridorResult(
        float(np.sum(share * steps) / (last - first)),
        max(float(excess[worst]), 0.0),
        float(time[worst]),
    )


def corridor_rows(
    results: Sequence[Result],
    named: Sequence[str],
    words: Sequence[str],
    tests: Sequence[Path],
    during: Window | None,
) -> tuple[list[list[str]], bool]:
    """A row for every channel beside every corridor of its kind; whether one leaves it."""
    rows, exceeds = [], False
    for test in map(read_test, tests):
        if test.corridor is None or not is_convertible(test.abscissa.unit, "s"):
            continue
        time = test.abscissa.values * factor(test.abscissa.unit, "s")
        for result, name in zip(results, named, strict=True):
            for choice in choices(result, words):
                series = result.series(choice.channel)
                unit = test.corridor[0].unit
                if not is_convertible(series.unit, unit):
                    continue
                history = series.time, series.values * factor(series.unit, unit)
                lower, upper = ((time, border.values) for border in test.corridor)
                rated = compare_with_corridor(history, lower, upper, during)
                exceeds = exceeds or rated.excess > 0.0
                sizes = [f"{100 * rated.inside:.4g} %", number(rated.excess), unit or "-"]
                rows.append([name, choice.channel, test.name, *sizes, number(rated.at)])
    return rows, exceeds
