"""Integral over time from the first sample on, by the trapezoidal rule: of second order."""

import numpy as np

from crashsolve.channels.series import cumulative
from crashsolve.channels.term import SECOND, Term

SAMPLED = True


def apply(time: np.ndarray, x: Term) -> Term:
    """The running integral."""
    return Term(cumulative(time, x.over(time)), x.product.times(SECOND))
