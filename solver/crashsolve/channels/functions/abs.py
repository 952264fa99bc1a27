"""Magnitude of each value."""

import numpy as np

from crashsolve.channels.term import Term


def apply(time: np.ndarray, x: Term) -> Term:
    """The absolute values, in the unit of x."""
    return Term(np.abs(x.values), x.unit)
