"""What restitution a damped power law really returns, and the damping that returns a wanted one.

For a free central impact with f = K delta^n (1 + chi delta_dot / v_0) the outgoing over the
incoming speed, x, solves

    chi (1 + x) = ln[(1 + chi) / (1 - chi x)]

whatever K, n, m and v_0 are, and goes d deep with
K d^(n+1) / ((n+1) m v_0^2) = 1/chi - ln(1 + chi)/chi^2. Proof: v dv / (1 + chi v / v_0)
= -(K/m) delta^n d(delta), integrated from v_0 to -x v_0.
"""

from collections.abc import Callable
from math import log


def returned(chi: float) -> float:
    """Restitution x of a free impact with damping factor chi."""
    if chi == 0.0:
        return 1.0
    return _root(lambda x: _defect(chi, x), 0.0, min(1.0, 1.0 / chi))


def damping_factor(e: float) -> float:
    """Damping factor chi with which a free impact returns the restitution e, 0 < e <= 1."""
    if e == 1.0:
        return 0.0
    # the defect also vanishes at chi = 0, as (1 - e^2) chi^2 / 2: start beyond it
    return _root(lambda chi: _defect(chi, e), min(1e-3, 1.0 - e), 1.0 / e)


def _defect(chi: float, x: float) -> float:
    """Positive below the root, in either argument."""
    if chi * x >= 1.0:
        return -1.0
    return chi * (1.0 + x) - log((1.0 + chi) / (1.0 - chi * x))


def _root(defect: Callable[[float], float], low: float, high: float) -> float:
    """Bisection down to the last bit of a function that is positive at `low`."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        if defect(middle) > 0.0:
            low = middle
        else:
            high = middle
