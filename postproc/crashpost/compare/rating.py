"""How well a history agrees with a measured one: the objective rating of ISO/TS 18571.

The rating itself is computed by objective-rating-metrics (extra `rating`); here both histories are
brought to the 10 kHz and the interval that it asks for.

References: ISO/TS 18571:2014.
"""

from typing import NamedTuple

import numpy as np

from crashpost.errors import PostError
from crashpost.values.measured import Column, Measurement
from crashsolve.channels.display import factor, is_convertible
from crashsolve.channels.series import Series

INTERVAL = 1e-4
# the shortest interval of which a fifth, the largest shift, is still a few samples
FEWEST = 50
GRADES = ((0.94, "excellent"), (0.80, "good"), (0.58, "fair"), (-1.0, "poor"))


class Rating(NamedTuple):
    """The overall rating and its parts, all from 0 to 1."""

    overall: float
    corridor: float
    phase: float
    magnitude: float
    slope: float

    @property
    def grade(self) -> str:
        """The word of the standard."""
        return next(word for least, word in GRADES if self.overall > least)


def rating(
    history: Series, test: Measurement, measured: Column, during: tuple[float, float] | None = None
) -> Rating:
    """The rating over the time that both cover, or over `during` [s].

    Raises PostError where times or units do not fit, the interval is too short, or a history rests.
    """
    try:
        from objective_rating_metrics.rating import ISO18571
    except ImportError:
        text = "ratings need objective-rating-metrics: pip install 'crashsolve[rating]'"
        raise PostError(text) from None
    if not is_convertible(test.abscissa.unit, "s"):
        raise PostError(f"test '{test.name}' is not over time, and cannot be rated")
    time = test.abscissa.values * factor(test.abscissa.unit, "s")
    values = measured.values * factor(measured.unit, history.unit)
    start, end = max(time[0], history.time[0]), min(time[-1], history.time[-1])
    if during:
        if not (start <= during[0] < during[1] <= end):
            raise PostError(f"test and result share {start:g} s to {end:g} s only")
        start, end = during
    count = int(np.floor((end - start) / INTERVAL * (1 + 1e-12))) + 1
    if count < FEWEST:
        raise PostError(f"test and result share less than {1e3 * FEWEST * INTERVAL:g} ms")
    grid = start + INTERVAL * np.arange(count)
    reference = np.interp(grid, time, values)
    own = np.interp(grid, history.time, history.values)
    if not np.ptp(reference) > 0 or not np.ptp(own) > 0:
        raise PostError("a history that does not change cannot be rated")
    scores = ISO18571(
        reference_curve=np.column_stack([grid, reference]),
        comparison_curve=np.column_stack([grid, own]),
        dt=INTERVAL,
    )
    parts = (
        scores.overall_rating(),
        scores.corridor_rating(),
        scores.phase_rating(),
        scores.magnitude_rating(),
        scores.slope_rating(),
    )
    return Rating(*map(float, parts))
