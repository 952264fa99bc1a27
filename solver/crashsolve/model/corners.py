"""Corners of prescribed motions and loads: steps end there, as no method keeps its order across
one.

A law names in CURVES_OF_TIME the columns that hold the curves it reads at the present time. A
corner is where the slope of such a curve jumps, or its bend by as much as within a piece: a formula
with a kink has the pieces around it bent sharply. Consequence to test: the impulse of a pulse made
of straight lines is exact, for any step.
"""

import numpy as np

from crashsolve.foundation.curve import HOLD
from crashsolve.foundation.distinct import distinct
from crashsolve.model.model import Model

# a jump of the slope above this share of the largest is no round-off of the points
SHARP = 1e-9
# and one of the bend, which over a piece makes this share of the largest slope: a smooth formula
# with 12 pieces or more in a period stays below
BENT = 0.01


def corners_in_time(model: Model) -> np.ndarray:
    """Times [s] of the corners of all curves of time, in order."""
    corners_of_curves = [corners(model.curves, first) for first in sorted(curves_of_time(model))]
    return distinct(np.concatenate(corners_of_curves)) if corners_of_curves else np.zeros(0)


def curves_of_time(model: Model) -> set[int]:
    """First points of the curves that laws read at the present time."""
    return {
        int(first)
        for group in model.groups
        for column in getattr(group.module, "CURVES_OF_TIME", ())
        for first in group.parameters[column]
        if first > 0
    }


def corners(curves: np.ndarray, first: int) -> np.ndarray:
    """Abscissas of the corners of the curve that begins with point `first`, including its ends."""
    points = curves[first : curves[first]["last"] + 1]
    x, c, length = points["x"], points["c"][:-1], np.diff(points["x"])
    slopes = np.stack([c[:, 1], c[:, 1] + length * (2 * c[:, 2] + 3 * length * c[:, 3])])
    bends = np.stack([2 * c[:, 2], 2 * c[:, 2] + 6 * length * c[:, 3]])
    # outside it continues straight, or level where it holds its value
    outside = 0.0 if points["beyond"][0] == HOLD else 1.0
    before, after = outside * slopes[0, 0], outside * slopes[1, -1]
    slope_jump = np.diff(np.stack([np.r_[before, slopes[1]], np.r_[slopes[0], after]]), axis=0)[0]
    bend_jump = np.diff(np.stack([np.r_[0.0, bends[1]], np.r_[bends[0], 0.0]]), axis=0)[0]
    shorter = np.minimum(np.r_[length[0], length], np.r_[length, length[-1]])
    steepest = np.abs(slopes).max()
    is_corner = np.abs(slope_jump) > SHARP * steepest
    is_corner |= np.abs(bend_jump) * shorter > BENT * steepest
    return x[is_corner]
