"""Length of a vector: the root of the sum of squares of up to three components."""

import numpy as np

from crashsolve.channels.term import Term, common_unit


def apply(time: np.ndarray, x: Term, y: Term | None = None, z: Term | None = None) -> Term:
    """The resultant, in the common unit; raises ChannelError where units differ."""
    terms = [term for term in (x, y, z) if term is not None]
    squares = sum(np.square(term.values) for term in terms)
    return Term(np.sqrt(squares), common_unit(*terms))
