"""Numbers once each: np.unique loads numpy.ma, which takes longer than reading a small deck."""

import numpy as np


def distinct(numbers: np.ndarray) -> np.ndarray:
    """Numbers once each, ascending (n,); of millions sorting is faster than hashes, too."""
    ordered = np.sort(numbers, axis=None)
    return ordered[np.r_[True, ordered[1:] != ordered[:-1]][: len(ordered)]]
