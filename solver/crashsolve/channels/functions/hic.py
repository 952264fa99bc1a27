"""Head Injury Criterion up to each moment, of windows not longer than the one given.

`hic(resultant(x, y, z), '15 ms')`; without a window, of any length. Its definition is that of
`_windows.py`. The statistic `final` or `max` is the criterion of the whole history, a pure number
by custom; hic_start and hic_end are the ends of its window.
"""

import numpy as np

from crashsolve.channels.display import Product
from crashsolve.channels.functions._windows import criterion
from crashsolve.channels.term import Term

SAMPLED = True


def apply(time: np.ndarray, a: Term, window: Term | None = None) -> Term:
    """The criterion so far; raises ChannelError for no acceleration, or no duration."""
    return Term(criterion(time, a, window, "hic").value, Product())
