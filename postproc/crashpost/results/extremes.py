"""Least and greatest values of many channels at once, read in slabs: a result may exceed memory."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

# of a slab [bytes]
SLAB = 1 << 24

Slab = tuple[int, np.ndarray]  # number of its first sample, values (n_time, n_id)


@dataclass(frozen=True)
class Extremes:
    """Extreme values of each entity (n_id,) over all samples, and the first sample of each."""

    least: np.ndarray
    least_row: np.ndarray
    greatest: np.ndarray
    greatest_row: np.ndarray

    @property
    def largest(self) -> np.ndarray:
        """Largest magnitudes."""
        sizes: np.ndarray = np.maximum(np.abs(self.least), np.abs(self.greatest))
        return sizes


def rows_of_a_slab(width: int) -> int:
    """Number of samples of so many entities in a slab."""
    return max(1, SLAB // (8 * max(width, 1)))


def extremes(slabs: Iterable[Slab], width: int) -> Extremes:
    """Extremes of slabs in the order of time; NaN without any."""
    least, greatest = np.full(width, np.nan), np.full(width, np.nan)
    rows = np.zeros((2, width), int)
    for first, values in slabs:
        for best, at, row, is_better in (
            (least, values.argmin(axis=0), rows[0], np.less),
            (greatest, values.argmax(axis=0), rows[1], np.greater),
        ):
            own = values[at, np.arange(width)]
            better = is_better(own, best) | np.isnan(best)
            best[better], row[better] = own[better], first + at[better]
    return Extremes(least, rows[0], greatest, rows[1])
