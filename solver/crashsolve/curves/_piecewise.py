"""Piecewise cubics through points, with coefficients in powers of x - x_i.

    y(x) = c0 + c1 s + c2 s^2 + c3 s^3,   s = x - x_i

References: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304 (smooth);
de Boor, A Practical Guide to Splines (1978), chapter IV (cubic).
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def coefficients(x: Array, y: Array, interpolation: str) -> Array:
    """Coefficients (n - 1, 4) of the curve through n points."""
    if interpolation == "linear":
        slope = np.diff(y) / np.diff(x)
        return np.stack([y[:-1], slope, 0.0 * slope, 0.0 * slope], axis=1)
    slopes = {"smooth": monotone_slopes, "cubic": spline_slopes}[interpolation](x, y)
    return hermite(x, y, slopes)


def hermite(x: Array, y: Array, slopes: Array) -> Array:
    """Cubics (n - 1, 4) with given values and slopes (n,) at the points (n,)."""
    h = np.diff(x)
    secant = np.diff(y) / h
    bend = slopes[:-1] + slopes[1:] - 2.0 * secant
    return np.stack([y[:-1], slopes[:-1], (secant - slopes[:-1] - bend) / h, bend / h**2], axis=1)


def monotone_slopes(x: Array, y: Array) -> Array:
    """Slopes (n,) that keep the curve within the values of its neighbours: no overshoot.

    Harmonic mean of the secants left and right; zero at a local extremum.
    """
    h = np.diff(x)
    secant = np.diff(y) / h
    if len(x) == 2:
        return np.repeat(secant, 2)
    left, right = secant[:-1], secant[1:]
    rising = left * right > 0.0
    weight = (h[:-1] + 2.0 * h[1:]) / (3.0 * (h[:-1] + h[1:]))
    bottom = np.where(rising, weight * right + (1.0 - weight) * left, 1.0)
    inner = np.where(rising, left * right / bottom, 0.0)
    first = _end_slope(h[0], h[1], secant[0], secant[1])
    last = _end_slope(h[-1], h[-2], secant[-1], secant[-2])
    return np.concatenate([[first], inner, [last]])


def _end_slope(h: float, h_next: float, secant: float, secant_next: float) -> float:
    """Slope of the parabola through three points at its end, limited to keep the shape."""
    slope = ((2.0 * h + h_next) * secant - h * secant_next) / (h + h_next)
    if slope * secant <= 0.0:
        return 0.0
    if secant * secant_next < 0.0 and abs(slope) > 3.0 * abs(secant):
        return 3.0 * secant
    return slope


def spline_slopes(x: Array, y: Array) -> Array:
    """Slopes (n,) of the natural cubic spline: second derivative continuous, 0 at the ends."""
    h = np.diff(x)
    secant = np.diff(y) / h
    below = np.concatenate([1.0 / h, [0.0]])
    above = np.concatenate([[0.0], 1.0 / h])
    diagonal = 2.0 * (below + above)
    pull = secant / h
    right = 3.0 * (np.concatenate([pull, [0.0]]) + np.concatenate([[0.0], pull]))
    return _tridiagonal(1.0 / h, diagonal, right)


def _tridiagonal(side: Array, diagonal: Array, right: Array) -> Array:
    """Solution of a symmetric tridiagonal system, by elimination from the top."""
    d, r = diagonal.copy(), right.copy()
    for i in range(1, len(d)):
        factor = side[i - 1] / d[i - 1]
        d[i] -= factor * side[i - 1]
        r[i] -= factor * r[i - 1]
    solution = np.empty_like(r)
    solution[-1] = r[-1] / d[-1]
    for i in range(len(d) - 2, -1, -1):
        solution[i] = (r[i] - side[i] * solution[i + 1]) / d[i]
    return solution
