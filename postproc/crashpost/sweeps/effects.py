"""Effects of the parameters of a sweep: main effects, and Sobol indices of Saltelli's design.

    mean of a measure over the runs with one value of a parameter, or in one class of its values,
    +- s / sqrt(n), the standard error of that mean
    S_i = V[E(y | x_i)] / V(y),   S_Ti = E[V(y | all but x_i)] / V(y)

References: Saltelli et al. (2010), Computer Physics Communications 181, 259-270; indices by SALib,
Herman and Usher (2017), Journal of Open Source Software 2(9), 97.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from crashpost.errors import PostError
from crashpost.sweeps.table import Sweep

# values of a parameter that are classes of their own, and classes of more values than these
MAX_VALUES, CLASSES = 12, 8
# blocks of Saltelli's design of which indices can be determined
LEAST_BLOCKS = 8


@dataclass(frozen=True)
class Effect:
    """Means of a measure by the values of a parameter, and their standard errors (NaN of one)."""

    at: list[Any]
    means: list[float]
    errors: list[float]
    counts: list[int]


def main_effect(values: Sequence[Any], measured: Sequence[float]) -> Effect:
    """The main effect of a parameter on a measure; runs without the measure do not count."""
    pairs = [(v, y) for v, y in zip(values, measured, strict=True) if isfinite(y)]
    is_of_words = any(isinstance(v, str) for v, _ in pairs)
    known = list(dict.fromkeys(v for v, _ in pairs))
    if not is_of_words:
        pairs.sort()
        known.sort()
    if is_of_words or len(known) <= MAX_VALUES:
        groups = [[pair for pair in pairs if pair[0] == value] for value in known]
    else:
        groups = _classes(pairs)
    at = [g[0][0] if is_of_words else float(np.mean([v for v, _ in g])) for g in groups]
    samples = [np.array([y for _, y in group]) for group in groups]
    errors = [_standard_error(y) for y in samples]
    return Effect(at, [float(y.mean()) for y in samples], errors, [len(y) for y in samples])


def _classes(pairs: list[tuple[Any, float]]) -> list[list[tuple[Any, float]]]:
    """Sorted pairs of value and measure in classes of about equal numbers."""
    edges = np.linspace(0, len(pairs), min(CLASSES, len(pairs) // 2) + 1).astype(int)
    return [pairs[a:b] for a, b in zip(edges[:-1], edges[1:], strict=True)]


def _standard_error(y: np.ndarray) -> float:
    return float(y.std(ddof=1) / np.sqrt(len(y))) if len(y) > 1 else float("nan")


@dataclass(frozen=True)
class Indices:
    """Sobol indices of a measure by parameter, each with half of its 95 % interval."""

    first: list[float]
    first_errors: list[float]
    total: list[float]
    total_errors: list[float]
    blocks: int
    lost: int


def indices(sweep: Sweep, at: int) -> Indices | str:
    """The indices of measure number `at`, or why there are none. Raises PostError without SALib."""
    if sweep.design != "saltelli":
        return "Sobol indices need design: {type: saltelli, runs: ...} in the plan"
    y = np.array([row.measured[at] for row in sweep.rows])
    return indices_of(y, len(sweep.axes))


def indices_of(y: np.ndarray, d: int) -> Indices | str:
    """Indices of d parameters from the answers of Saltelli's design, without incomplete blocks.

    Raises PostError without SALib.
    """
    try:
        from SALib.analyze import sobol
    except ImportError:
        raise PostError("Sobol indices need SALib: pip install 'crashsolve[sweep]'") from None
    blocks = y.reshape(-1, d + 2)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    lost = len(blocks) - len(whole)
    if len(whole) < LEAST_BLOCKS:
        return (
            f"{len(whole)} of {len(blocks)} blocks of runs are complete; {LEAST_BLOCKS} are needed"
        )
    if np.ptp(whole) <= 1e-12 * np.max(np.abs(whole)):
        return "the measure does not vary"
    problem = {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}
    analysis = sobol.analyze(problem, whole.ravel(), calc_second_order=False, seed=1)
    first, first_errors, total, total_errors = (
        [float(x) for x in analysis[name]] for name in ("S1", "S1_conf", "ST", "ST_conf")
    )
    return Indices(first, first_errors, total, total_errors, len(whole), lost)
