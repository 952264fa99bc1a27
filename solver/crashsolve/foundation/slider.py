"""An elastic line of slope k on a slider that slides at a curve: where they meet, and its work.

    c(e) = k (e - s),   G(e) = int c de - c^2 / 2k

Springs and paddings that load on one curve and unload on another move the slider s along both.
"""

from crashsolve.foundation.curve import curve_area, curve_value
from crashsolve.foundation.kernels import kernel


@kernel
def work(curves, curve, side, k, e):
    """G(e) = int c de - c^2 / 2k, the work on the slider up to e [J]."""
    c = curve_value(curves, curve, side * e)[0]
    area = curve_area(curves, curve, side * e) - curve_area(curves, curve, 0.0)
    return area - 0.5 * c * c / k


@kernel
def line_meets(curves, curve, side, k, s, high):
    """The e in [s, high] where k (e - s) meets the curve, whose slope is below k (Newton)."""
    low, e = s, high
    for _ in range(60):
        y, slope, _ = curve_value(curves, curve, side * e)
        excess = k * (e - s) - side * y
        if excess > 0.0:
            high = e
        else:
            low = e
        following = e - excess / (k - slope)
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - e) <= 1e-15 * abs(e):
            break
        e = following
    return e
