"""Least and greatest values over spans of samples, all at once."""

import numpy as np


class Spans:
    """Greatest of values (n,) from sample `first` to `last`, both included.

    A table of the greatest of 1, 2, 4, ... samples from each one on: two of them cover any span.
    """

    def __init__(self, values: np.ndarray) -> None:
        self.levels = [values]
        while 2 ** len(self.levels) <= len(values):
            half, width = self.levels[-1], 2 ** (len(self.levels) - 1)
            self.levels.append(np.maximum(half[:-width], half[width:]))

    def greatest(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """The largest value of each span (n,), in the unit of the values.

        Minus infinity of an empty one, where `last` is before `first`.
        """
        maxima = np.full(len(first), -np.inf)
        width = last - first + 1
        for level, values in enumerate(self.levels):
            on_level = (width >= 2**level) & (width < 2 ** (level + 1))
            right = last[on_level] - 2**level + 1
            maxima[on_level] = np.maximum(values[first[on_level]], values[right])
        return maxima
