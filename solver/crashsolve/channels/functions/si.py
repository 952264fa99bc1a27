"""Severity Index: SI = integral of a^2.5 dt, a in g, t in s; up to each moment.

a is the magnitude, so that of one axis its sign does not matter: take the resultant of three. The
integral is by the trapezoidal rule, of second order in the interval of the samples, of first order
across a jump. The statistic `final` or `max` is the index of the whole history.

References: Gadd (1966), SAE 660793; SAE J885 (2011).
"""

import numpy as np

from crashsolve.channels.display import Product
from crashsolve.channels.series import cumulative
from crashsolve.channels.term import Term, in_gravities

SAMPLED = True
EXPONENT = 2.5


def apply(time: np.ndarray, a: Term) -> Term:
    """The index so far, a pure number by custom; raises ChannelError for no acceleration."""
    return Term(cumulative(time, in_gravities(a, time, "si") ** EXPONENT), Product())
