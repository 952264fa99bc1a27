"""When the window of the Head Injury Criterion so far ends: of the whole history `final`."""

import numpy as np

from crashsolve.channels.functions._windows import criterion
from crashsolve.channels.term import SECOND, Term

SAMPLED = True
IS_SAMPLE_TIME = True


def apply(time: np.ndarray, a: Term, window: Term | None = None) -> Term:
    """The time [s]; raises ChannelError for no acceleration, or no duration."""
    return Term(criterion(time, a, window, "hic_end").end, SECOND)
