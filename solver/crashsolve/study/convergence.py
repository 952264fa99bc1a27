"""Orders of convergence and estimates of error from runs with ever shorter steps.

    |x1 - x2| / |x2 - x3| = (h1^p - h2^p) / (h2^p - h3^p)        p, the observed order
    x* = x3 + (x3 - x2) / ((h2/h3)^p - 1)                        x*, the extrapolated value

A value x is an array: one number, or a history at equal sample times; |.| is its largest element.
Consequence to test: x = 1 + h^2 gives p = 2 and x* = 1 for any three steps.

Reference: Roache (1994), J. Fluids Eng. 116, 405-413.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf, log, nan

import numpy as np

# differences that shrink by less than a tenth do not count as shrinking
SHRINKS = 0.9
# differences larger than this many times those of longer steps have grown: not by their scatter
GROWS = 2.0
# differences below this share of the value are round-off and the tolerance of the constraints
ROUND_OFF = 1e-9
# an observed order this near the method's is taken for it
NEAR = 0.5
# differences that stay, but this far below the largest, are a floor and no divergence
FLOOR = 1e-3
HIGHEST = 16.0
# steps that are nearer to each other than this ratio state no order
RATIO = 1.1


@dataclass(frozen=True)
class Convergence:
    """Convergence of one value over the runs of one method, from the longest step to the shortest.

    `error` is the estimated error of the last one, in the unit of the value; `orders` begin with
    the third run; `stalls` is the run from which on the differences shrink no more; then
    `has_floor` states that they have become small before. `grows` states that they are larger again
    for shorter steps; then `value` is that of the run `stalls`, which agreed best with the one
    before it.
    """

    value: np.ndarray
    error: float
    orders: list[float] = field(default_factory=list)
    stalls: int | None = None
    is_extrapolated: bool = False
    has_floor: bool = False
    grows: bool = False

    @property
    def diverges(self) -> bool:
        """Whether shorter steps have led nowhere."""
        return self.stalls is not None and not self.has_floor

    @property
    def is_steady(self) -> bool:
        """Whether the last differences shrank twice, or have reached a floor."""
        return self.has_floor or (
            len(self.orders) > 1 and bool(np.all(np.isfinite(self.orders[-2:])))
        )

    @property
    def order(self) -> float:
        """The last order that could be observed; NaN when none could."""
        return next((p for p in reversed(self.orders) if np.isfinite(p)), nan)


def distance(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of two values (n,), in their unit."""
    return float(np.max(np.abs(a - b)))


def analyse(
    steps: Sequence[float], values: Sequence[np.ndarray], order: float | None
) -> Convergence:
    """Observed orders, extrapolated value and estimated error of runs of a method of an order.

    `steps` [s] (runs,), the longest first; `values` (n,) of each run, in their unit.
    """
    differences = [distance(a, b) for a, b in pairwise(values)]
    last = values[-1]
    if len(values) < 3:
        # the difference of two runs is known, but not how much of it is left as error
        return Convergence(last, differences[-1] if differences else inf)
    floor = ROUND_OFF * float(np.max(np.abs(last)))
    orders = [
        observed_order(steps[i : i + 3], differences[i : i + 2])
        if min(differences[i : i + 2]) > floor
        else nan
        for i in range(len(differences) - 1)
    ]
    stalls = _stall(differences, floor)
    if differences[-1] <= floor:
        return Convergence(last, differences[-1], orders, has_floor=True)
    least = _growth(differences, orders, order, floor)
    if least is not None:
        left = max(differences[least + 1 :])
        has_floor = left <= FLOOR * max(differences)
        value = last if has_floor else values[least + 1]
        return Convergence(value, left, orders, least + 1, has_floor=has_floor, grows=not has_floor)
    if stalls is not None:
        left = max(differences[-2:])
        return Convergence(last, left, orders, stalls, has_floor=left <= FLOOR * max(differences))
    p = orders[-1]
    is_near = order is not None and abs(p - order) <= NEAR
    # an order higher than the method's, or than can be determined, is no ground for a smaller error
    power = order if order and not p < order - NEAR else p
    power = power if np.isfinite(power) else HIGHEST
    rest = (last - values[-2]) / ((steps[-2] / steps[-1]) ** power - 1.0)
    left = float(np.max(np.abs(rest)))
    return Convergence(last + rest if is_near else last, left, orders, None, is_near)


def observed_order(steps: Sequence[float], differences: Sequence[float]) -> float:
    """Order [1] from three steps [s] and the two differences; NaN when these do not shrink."""
    h1, h2, h3 = steps
    if not differences[1] < differences[0] or not h1 > h2 > h3:
        return nan
    wanted, low, high = differences[0] / differences[1], 1e-3, HIGHEST

    def ratio(p: float) -> float:
        return float((h1**p - h2**p) / (h2**p - h3**p))

    if not ratio(low) < wanted < ratio(high):
        return nan
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio(middle) < wanted else (low, middle)
    return low


def order_of_errors(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Order [1] from two steps [s] and their errors; NaN when an error is zero or unknown, the
    steps are nearly the same, or no method has such an order.
    """
    (h1, h2), (e1, e2) = steps, errors
    if not (h1 > RATIO * h2 > 0.0 and e1 > 0.0 and e2 > 0.0):
        return nan
    order = log(e1 / e2) / log(h1 / h2)
    return order if abs(order) < HIGHEST else nan


def divergence_time(time: np.ndarray, values: Sequence[np.ndarray]) -> float | None:
    """First time [s] at which the differences of the three last histories shrink no more."""
    coarse, middle, fine = values[-3:]
    # histories that differed once count as different from then on, for they may cross
    before = np.maximum.accumulate(np.abs(coarse - middle))
    after = np.maximum.accumulate(np.abs(middle - fine))
    differences = (after > SHRINKS * before) & (after > 1e-3 * after[-1])
    return float(time[np.argmax(differences)]) if differences.any() else None


def _growth(
    differences: Sequence[float], orders: Sequence[float], order: float | None, floor: float
) -> int | None:
    """The least of the differences, if shorter steps make them grow beyond it; else None.

    Where the last two orders are the method's, longer steps had agreed by luck.
    """
    is_settled = order is not None and all(abs(p - order) <= NEAR for p in orders[-2:])
    if is_settled and len(orders) > 1:
        return None
    least = min(range(len(differences)), key=differences.__getitem__)
    grown = max(differences[least + 1 :], default=0.0)
    return least if grown > max(GROWS * differences[least], floor) else None


def _stall(differences: Sequence[float], floor: float) -> int | None:
    """The run from which on the differences shrink no more; None when the last ones do."""
    shrinks = [b <= max(SHRINKS * a, floor) for a, b in pairwise(differences)]
    if shrinks[-1]:
        return None
    # the trailing pairs that do not shrink begin after the last one that does
    first = max((i + 1 for i, good in enumerate(shrinks) if good), default=0)
    return first + 1
