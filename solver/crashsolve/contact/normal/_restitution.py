"""What restitution a damped power law really returns, and the damping that returns a wanted one.

For a free central impact with f = K delta^n (1 + chi delta_dot / v_0) the closing speed u = s v_0
at depth delta obeys

    K delta^(n+1) / ((n+1) m v_0^2) = G(1) - G(s),   G(s) = s/chi - ln(1 + chi s)/chi^2

whatever K, n, m and v_0 are. Proof: v dv / (1 + chi v / v_0) = -(K/m) delta^n d(delta), integrated
from v_0. Its largest depth is that where s = 0, and it parts with x v_0, the root of G(-x) = G(1):

    chi (1 + x) = ln[(1 + chi) / (1 - chi x)]
"""

from collections.abc import Callable
from functools import cache
from math import inf, log1p, sqrt

from crashsolve.foundation.kernels import kernel

# below it G is its series, whose next term is below round-off
SMALL = 1e-4
# halvings of a bracket: more than there are digits
HALVINGS = 100


@cache
def returned(chi: float) -> float:
    """Restitution x [1], 0 to 1, of a free impact with damping factor chi [1], 0 or more."""
    if chi == 0.0:
        return 1.0
    return _root(lambda x: _defect(chi, x), 0.0, min(1.0, 1.0 / chi))


@cache
def damping_factor(e: float) -> float:
    """Damping factor chi [1] with which a free impact returns the restitution e, 0 < e <= 1."""
    if e == 1.0:
        return 0.0
    return _root(lambda chi: _defect(chi, e), 0.0, 1.0 / e)


@kernel
def spent(chi, s):
    """G(s): share of m v_0^2 that the speed s v_0 is worth against a force damped by chi."""
    z = chi * s
    if abs(z) < SMALL:
        return s * s * (0.5 - z * (1.0 / 3.0 - z * (0.25 - 0.2 * z)))
    # a damped force never pulls: the rebound is slower than v_0 / chi
    return (z - log1p(z)) / (chi * chi) if z > -1.0 else inf


@kernel
def speed_through(chi, x, energy, rate):
    """Impact speed v of the free impact whose motion passes a state [m/s].

        v^2 (G(1) - G(rate / v)) = energy

    The state is a closing speed [m/s] and the energy of the spring over the effective mass
    [m^2/s^2]; x is the restitution returned. The left side grows with v.
    """
    low = max(rate, -rate / x, 0.0)
    high = sqrt(energy / spent(chi, 1.0) + max(0.5 * rate * rate / spent(chi, 1.0), low * low))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if middle * middle * (spent(chi, 1.0) - spent(chi, rate / middle)) < energy:
            low = middle
        else:
            high = middle
    return high


def _defect(chi: float, x: float) -> float:
    """Positive below the root, in either argument."""
    return float(spent(chi, 1.0) - spent(chi, -x))


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
