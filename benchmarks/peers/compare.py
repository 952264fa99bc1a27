"""CPU time that each code needs for a given error."""

from itertools import pairwise
from math import exp, inf, log

from problem import Point

TARGETS = [1e-2, 1e-4, 1e-6, 1e-8]
CODES = ["crashsolve", "exudyn", "mujoco"]


def cost(points: list[Point], target: float) -> float:
    """CPU time [s] of one method: of a run that is as good, or between two runs, on straight lines
    of logarithms. Nothing is continued beyond the runs made."""
    costs = [point.cpu for point in points if point.error <= target]
    for a, b in pairwise(points):
        low, high = sorted((a, b), key=lambda point: point.error)
        if 0.0 < low.error < target < high.error < inf:
            share = (log(high.error) - log(target)) / (log(high.error) - log(low.error))
            costs.append(exp(log(high.cpu) + share * (log(low.cpu) - log(high.cpu))))
    return min(costs, default=inf)


def best(points: list[Point], code: str, target: float) -> tuple[float, str]:
    """Least CPU time of a code over its methods, and which method that is."""
    methods = dict.fromkeys(point.method for point in points if point.code == code)
    solvers = [
        (cost([p for p in points if (p.code, p.method) == (code, name)], target), name)
        for name in methods
    ]
    return min(solvers, default=(inf, ""))


def at_equal_error(points: list[Point]) -> list[list[str]]:
    """Rows: error, CPU time and method of each code, crashsolve over the best peer."""
    rows = []
    for target in TARGETS:
        times = {code: best(points, code, target) for code in CODES}
        own, peer = times["crashsolve"][0], min(times[code][0] for code in CODES[1:])
        rows.append([f"{target:.0e}", *(shown(*times[code]) for code in CODES), ratio(own, peer)])
    return rows


def shown(seconds: float, method: str) -> str:
    return "not reached" if seconds == inf else f"{1e3 * seconds:.3g} ({method})"


def ratio(own: float, peer: float) -> str:
    if own == inf and peer == inf:
        return "nobody"
    if own == inf:
        return "only peers"
    return "only crashsolve" if peer == inf else f"{own / peer:.2g}"
