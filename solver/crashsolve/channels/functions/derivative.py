"""Derivative in time, by central differences of second order, at the ends as well."""

import numpy as np

from crashsolve.channels.errors import ChannelError
from crashsolve.channels.term import SECOND, Term

SAMPLED = True


def apply(time: np.ndarray, x: Term) -> Term:
    """The slope; raises ChannelError for fewer than two samples."""
    if len(time) < 2 or not np.all(np.diff(time) > 0):
        raise ChannelError("derivative() needs two or more samples at strictly increasing times")
    slope = np.gradient(x.over(time), time, edge_order=2 if len(time) > 2 else 1)
    return Term(slope, x.product.times(SECOND, -1))
