"""The points of a sweep: combination of the values.

grid            every value of each parameter with every value of the others, the last one fastest
list            the first values together, then the second ones, ...
latin_hypercube one value in each of n equally likely shares of every parameter
sobol           a scrambled Sobol sequence: n = 2^m values that fill the ranges evenly
saltelli        for every pair of rows a, b of such a sequence of twice as many parameters:
                a, a with each value in turn from b, b;   n (d + 2) runs

Consequence to test: a share of 1/n of every parameter holds one value of a Latin hypercube.

References: McKay, Beckman and Conover (1979), Technometrics 21(2), 239-245; Owen (1998), Journal of
Complexity 14(4), 466-489; Saltelli et al. (2010), Computer Physics Communications 181, 259-270.
"""

from itertools import product
from math import prod

import numpy as np

from crashsolve.foundation.errors import DeckError
from crashsolve.sweep.plan import DRAWN, MAX_RUNS, Plan

# by the name of a varied parameter, its value as --set takes it
Point = dict[str, str]
# half of the finest division of scipy's Sobol sequence: no value is at an end of its distribution
EDGE = 2.0**-31


def points_of(plan: Plan) -> list[Point]:
    """All points of a plan in order. Raises DeckError where there are too many, or scipy is not."""
    design, axes = plan.card.design, plan.axes
    if design.type in DRAWN:
        return [
            {name: axis.text(u) for (name, axis), u in zip(axes.items(), row, strict=True)}
            for row in _drawn(plan)
        ]
    columns = [axis.texts() for axis in axes.values()]
    count = prod(map(len, columns)) if design.type == "grid" else len(columns[0])
    if count > MAX_RUNS:
        raise _refusal(plan, f"the design has {count} runs", f"at most {MAX_RUNS} are possible")
    is_grid = design.type == "grid"
    rows = list(product(*columns) if is_grid else zip(*columns, strict=True))
    return [dict(zip(axes, row, strict=True)) for row in rows]


def _drawn(plan: Plan) -> list[list[float]]:
    """Shares of the distributions, a row for each run."""
    try:
        from scipy.stats import qmc
    except ImportError:
        advice = "pip install 'crashsolve[sweep]'"
        raise _refusal(plan, f"{plan.card.design.type} needs scipy", advice) from None
    design, d = plan.card.design, len(plan.axes)
    n = design.runs or 0
    if design.type == "saltelli":
        if n * (d + 2) > MAX_RUNS:
            message = f"saltelli makes {n} x ({d} + 2) = {n * (d + 2)} runs"
            raise _refusal(plan, message, f"at most {MAX_RUNS} are possible")
        rows = _between(qmc.Sobol(2 * d, rng=design.seed).random(n))
        return [row for pair in rows for row in _crossed(pair[:d], pair[d:])]
    if design.type == "sobol":
        return _between(qmc.Sobol(d, rng=design.seed).random(n))
    return _between(qmc.LatinHypercube(d, rng=design.seed).random(n))


def _crossed(a: list[float], b: list[float]) -> list[list[float]]:
    """The rows of one block of Saltelli's design, in the order that SALib expects."""
    return [a, *([*a[:i], b[i], *a[i + 1 :]] for i in range(len(a))), b]


def _between(rows: np.ndarray) -> list[list[float]]:
    return [[min(max(float(u), EDGE), 1.0 - EDGE) for u in row] for row in rows]


def _refusal(plan: Plan, message: str, advice: str) -> DeckError:
    return DeckError(str(plan.path), None, None, "design", message, advice)
