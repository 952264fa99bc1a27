"""Extremes of every channel, kept while rows are written, and their table peaks.txt."""

from pathlib import Path

import numpy as np

from crashsolve.output.channels import Family
from crashsolve.output.files import replace_text

# compared at once: row by row, numpy takes twice as long for the few numbers of each
ROWS = 16


class Extremes:
    """Least and greatest value of every channel with the first time each occurred."""

    def __init__(self, families: tuple[Family, ...]) -> None:
        self.families = families
        shapes = [(len(family.columns), len(family.ids)) for family in families]
        # one array (n_column, n_id) for each family
        self.least = [np.full(shape, np.inf) for shape in shapes]
        self.greatest = [np.full(shape, -np.inf) for shape in shapes]
        self.least_time = [np.full(shape, np.nan) for shape in shapes]
        self.greatest_time = [np.full(shape, np.nan) for shape in shapes]

    def update(self, family: int, times: np.ndarray, values: np.ndarray) -> None:
        """Take in rows: times (k,), values (n_column, k, n_id)."""
        for two, where, bound, bound_time, better in (
            (np.minimum, np.argmin, self.least[family], self.least_time[family], np.less),
            (np.maximum, np.argmax, self.greatest[family], self.greatest_time[family], np.greater),
        ):
            # few channels have new ones in any block
            column, entity = np.nonzero(better(_extreme(two, values), bound))
            histories = values[column, :, entity]
            at = where(histories, axis=1)
            bound[column, entity] = histories[np.arange(len(at)), at]
            bound_time[column, entity] = times[at]


def _extreme(two: np.ufunc, values: np.ndarray) -> np.ndarray:
    """Extreme (n_column, n_id) over rows of values (n_column, k, n_id); `two`: of two numbers."""
    values_of_rows = values[:, :ROWS].copy()
    for first in range(ROWS, values.shape[1], ROWS):
        more = values[:, first : first + ROWS]
        own = values_of_rows[:, : more.shape[1]]
        two(own, more, out=own)
    extreme: np.ndarray = two.reduce(values_of_rows, axis=1)
    return extreme


def write_peaks(path: Path | str, extremes: Extremes) -> None:
    """Write the table channel, unit, min, at, max, at; times in seconds."""
    rows: list[tuple[str, ...]] = [("channel", "unit", "min", "at s", "max", "at s")]
    for number, family in enumerate(extremes.families):
        numbers = (
            extremes.least[number],
            extremes.least_time[number],
            extremes.greatest[number],
            extremes.greatest_time[number],
        )
        for entity in range(len(family.ids)):
            for index, column in enumerate(family.columns):
                cells = [f"{table[index, entity]:.6g}" for table in numbers]
                rows.append((family.channel(entity, index), column.unit or "-", *cells))
    replace_text(Path(path), "\n".join(_aligned(rows)) + "\n")


def _aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """Pad the cells of a table: words to the left, numbers to the right."""
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        words = [cell.ljust(width) for cell, width in zip(row[:2], widths[:2], strict=True)]
        numbers = [cell.rjust(width) for cell, width in zip(row[2:], widths[2:], strict=True)]
        lines.append("  ".join([*words, *numbers]))
    return lines
