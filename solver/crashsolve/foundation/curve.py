"""Curves of a deck as piecewise cubics, evaluated with two derivatives.

    y(x) = c0 + c1 s + c2 s^2 + c3 s^3,   s = x - x_i,   x_i <= x < x_(i+1)

A table with straight segments has c2 = c3 = 0. Consequence to test: value and slope of a cubic
are exact, a table is hit at its points, and the area under a curve is exact. All curves of a scene
lie end to end in one array; a curve is known by the index of its first point, and row 0 notes a
reading outside the range.
"""

from collections.abc import Sequence

import numpy as np

from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record

# breakpoints (n,), coefficients of cubics between them (n - 1, 4), code of extrapolation
Pieces = tuple[np.ndarray, np.ndarray, int]
REFUSE, HOLD, LINEAR = 0, 1, 2

POINT = Record("""
    x         1         breakpoint
    c         1      4  coefficients in powers of x - x_i
    area      1         integral of y from the first point to x_i
    moment    1         integral of that integral
    farthest  1         of the first point: largest x read beyond the range in a run; 0 for none
    last      index     last point of the curve that starts here
    beyond    flag      REFUSE, HOLD or LINEAR outside the range
    fault     index     row 0: first point of the curve last read outside its range; -body: folded
""")


def pack(curves: Sequence[Pieces]) -> tuple[np.ndarray, list[int]]:
    """Points of all curves and the first point of each.

    Each curve is given as breakpoints (n,), coefficients (n-1, 4), behaviour outside.
    """
    points = np.zeros(1 + sum(len(x) for x, _, _ in curves), POINT.dtype)
    first, starts = 1, []
    for x, coefficients, beyond in curves:
        part = points[first : first + len(x)]
        part["x"] = x
        part["c"][:-1] = coefficients
        part["area"][1:] = np.cumsum(_areas(np.diff(x), np.asarray(coefficients)))
        part["moment"][1:] = np.cumsum(
            part["area"][:-1] * np.diff(x) + _moments(np.diff(x), np.asarray(coefficients))
        )
        part["last"] = first + len(x) - 1
        part["beyond"] = beyond
        starts.append(first)
        first += len(x)
    return points, starts


def _areas(s: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Integral of each cubic over its segment of length s."""
    return s * (c[:, 0] + s * (c[:, 1] / 2 + s * (c[:, 2] / 3 + s * c[:, 3] / 4)))


def _moments(s: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Integral of the integral of each cubic over its segment of length s."""
    return s * s * (c[:, 0] / 2 + s * (c[:, 1] / 6 + s * (c[:, 2] / 12 + s * c[:, 3] / 20)))


@kernel
def curve_value(curves, k, x):
    """Value, first and second derivative at x of the curve whose first point is k.

    Writes: curves[0].fault and x where the curve must not be read, farthest beyond its end.
    """
    first, last = curves[k].x, curves[curves[k].last].x
    outside = x < first or x > last
    if outside and curves[k].beyond == REFUSE:
        curves[0].fault = k
        curves[0].x = x
    at = min(max(x, first), last)
    point = curves[segment(curves, k, curves[k].last, at)]
    s = at - point.x
    c = point.c
    y = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
    y1 = c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])
    if not outside:
        return y, y1, 2.0 * c[2] + 6.0 * s * c[3]
    curves[k].farthest = max(curves[k].farthest, x)
    if curves[k].beyond == LINEAR:
        return y + y1 * (x - at), y1, 0.0
    return y, 0.0, 0.0


@kernel
def curve_line(curves, k, x):
    """Value at 0 and slope of the tangent at x, and up to where it is the curve; -1 if nowhere.

    Writes: curves[0] as `curve_value` does.
    """
    y, slope, _ = curve_value(curves, k, x)
    last = curves[k].last
    end = curves[k].x if x < curves[k].x else 1e300
    if curves[k].x <= x and x <= curves[last].x:
        i = segment(curves, k, last, x)
        is_straight = curves[i].c[2] == 0.0 and curves[i].c[3] == 0.0
        end = curves[i + 1].x if is_straight else -1.0
    return y - slope * x, slope, end


@kernel
def curve_area(curves, k, x):
    """Integral of y from the first point of the curve to x, which may lie outside its range."""
    first, last = curves[k].x, curves[curves[k].last].x
    at = min(max(x, first), last)
    point = curves[segment(curves, k, curves[k].last, at)]
    s = at - point.x
    c = point.c
    inside = point.area + s * (c[0] + s * (c[1] / 2.0 + s * (c[2] / 3.0 + s * c[3] / 4.0)))
    if x == at:
        return inside
    y, slope, _ = curve_value(curves, k, at)
    beyond = x - at
    return inside + beyond * (y + (0.5 * beyond * slope if curves[k].beyond == LINEAR else 0.0))


@kernel
def curve_moment(curves, k, x):
    """Integral of that integral, from the first point of the curve to x."""
    first, last = curves[k].x, curves[curves[k].last].x
    at = min(max(x, first), last)
    point = curves[segment(curves, k, curves[k].last, at)]
    s = at - point.x
    c = point.c
    own = s * s * (c[0] / 2.0 + s * (c[1] / 6.0 + s * (c[2] / 12.0 + s * c[3] / 20.0)))
    inside = point.moment + s * point.area + own
    if x == at:
        return inside
    y, slope, _ = curve_value(curves, k, at)
    beyond = x - at
    more = y / 2.0 + (beyond * slope / 6.0 if curves[k].beyond == LINEAR else 0.0)
    return inside + beyond * curve_area(curves, k, at) + beyond * beyond * more


@kernel
def segment(curves, low, high, at):
    """Index i with x[i] <= at < x[i + 1], by bisection."""
    while high - low > 1:
        middle = (low + high) // 2
        if curves[middle].x <= at:
            low = middle
        else:
            high = middle
    return low
