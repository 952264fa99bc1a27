"""The error by the mesh: a run on elements twice as long, and one on elements four times as long.

    d1 = |x1 - x2|,  d2 = |x2 - x4|,  p = log2(d2 / d1), no more than the elements' order q
    three meshes        error = d1 / (2^p - 1), at least d2 / (2^s (2^s - 1)), s = max(q, 2)
    of opposite signs   error = d1, at least d2 / (2^s (2^s - 1)), where d1 < d2 / 4; else d2
    two meshes          error = d1, that of order 1: contact and yield have no more
    at a moment         at least a quarter of the root mean square of x1 - x2 about that moment:
    of an extreme       histories that cross there agree by chance; about an extreme, while the
                        history is in the half of its range that ends there

No error follows from the meshes where x1 and x2 differ by more than half the scale of the number,
or where d1 is no smaller than d2, or of the other sign, and more than a twentieth of the scale: the
message then names folding, softening and perforation. Consequence to test: x = 1 + l^q gives the
error l^q.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, log2

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistic import requested_moment
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.estimate.companion import BudgetExceeded, Companions
from crashsolve.estimate.error import Estimate
from crashsolve.foundation.errors import CrashsolveError, SolverError
from crashsolve.recording.samples import Samples
from crashsolve.study.convergence import NEAR, SHRINKS, distance
from crashsolve.study.meshes import coarser, has_mesh
from crashsolve.study.watch import Watch

FACTORS = (2, 4)
# order of elements without contact and yield
SMOOTH = 2.0
# shares of the scale
TOO_FAR, NOTABLE = 0.5, 0.05
# of d2: a smaller d1 of the other sign is that of elements which are small enough
MUCH_LESS = 0.25
# histories about a moment, as a share of the run on either side, and the share of their difference
# that is no chance: below the mean of |sin|, 0.64 of its largest value
ABOUT, CHANCE_MARGIN = 0.05, 0.25
EXTREMES = ("max", "min", "abs_max")
# share of the cost of the run, and CPU time [s], that its coarser meshes may cost unasked
SHARE, LEAST = 0.25, 0.3
OVER_BUDGET = (
    "the error estimates do not cover the mesh: a run on elements twice as long would cost "
    "more than a quarter of this one; control.estimate: mesh makes it nevertheless"
)


@dataclass
class Meshes:
    """Runs on coarser meshes, from elements twice as long on, and why there are no more."""

    runs: list[Samples]
    problem: str = ""


def coarse_runs(
    deck: Deck, start: Callable[[Deck], Companions], coarseness: float, budget: float = inf
) -> Meshes:
    """Runs of a deck on coarser meshes for at most `budget` [s] of CPU. Raises Abandoned.

    `made` are the companions of another deck: its channels are columns of its own.
    """
    meshes = Meshes([])
    if not has_mesh(deck):
        return meshes
    for factor in FACTORS:
        try:
            companions = start(_coarse(deck, factor))
            companions.budget = budget
            meshes.runs.append(companions.run(coarseness))
            budget = companions.budget
        except BudgetExceeded:
            problem = OVER_BUDGET
        except ValueError as why:
            problem = f"the error estimates do not cover the mesh: {why}"
        except SolverError as error:
            problem = f"the run on elements {factor} times as long stopped: {error.cause}"
        except CrashsolveError as error:
            reason = str(error).splitlines()[0]
            problem = (
                f"the error estimates do not cover the mesh; on elements {factor} times as long: "
                f"{reason}"
            )
        else:
            continue
        if not meshes.runs:
            meshes.problem = problem
        break
    return meshes


def _coarse(deck: Deck, factor: int) -> Deck:
    """The deck on a coarser mesh, with the control and output that it has by now."""
    given = deck.given | coarser(deck, factor)
    coarse = read_deck(deck.path, given, refuses_ineffective=False)
    if coarse.written != deck.written:
        raise ValueError("the files of the deck have changed since the run began")
    return replace(
        coarse,
        control=deck.control,
        output=deck.output,
        watch=deck.watch,
        watch_at=deck.watch_at,
        expect=deck.expect,
        expect_at=deck.expect_at,
    )


def window_about(watch: Watch, start: float, end: float) -> Watch | None:
    """The history about the moment that a number reads; None where it reads no moment."""
    if watch.statistic == PATH or watch.during:
        return None
    moment = end if watch.statistic == "final" else requested_moment(watch.statistic)
    if moment is None:
        return None
    margin = ABOUT * (end - start)
    window = (max(start, moment - margin), min(end, moment + margin))
    return replace(watch, statistic=PATH, during=window)


def window_about_extreme(watch: Watch, series: Series) -> Watch | None:
    """The history about the extreme that a number reads; None where it reads none.

    That is while the `series` stays in the half of its range that ends at the extreme. A channel
    that is a largest value so far has its extreme at the end.
    """
    if watch.statistic not in EXTREMES:
        return None
    signed = np.abs(series.values) if watch.statistic == "abs_max" else series.values
    signed = -signed if watch.statistic == "min" else signed
    at = int(np.argmax(signed))
    lower = np.flatnonzero(signed < 0.5 * (signed[at] + signed.min()))
    before, after = lower[lower < at], lower[lower > at]
    first = before[-1] + 1 if len(before) else 0
    last = after[0] - 1 if len(after) else len(signed) - 1
    window = (float(series.time[first]), float(series.time[last]))
    return replace(watch, statistic=PATH, during=window)


def chance_margin(paths: Sequence[np.ndarray]) -> float:
    """The least error by the mesh, of histories (n,) about a moment or an extreme on this mesh and
    a coarser.
    """
    return CHANCE_MARGIN * float(np.sqrt(np.mean((paths[0] - paths[1]) ** 2)))


def with_mesh(
    estimate: Estimate, numbers: Sequence[np.ndarray], deck: Deck, least: float = 0.0
) -> Estimate:
    """An estimate with the error by the mesh in it, `least` or more; `numbers` of this mesh and
    coarser ones.
    """
    if estimate.error is None:
        return estimate
    # a run without a mesh needs no settings of studies
    from crashsolve.study.settings import order_of_mesh

    size, how = mesh_error(numbers, estimate.scale, order_of_mesh(deck) or 1.0)
    if size is None:
        is_one = len(numbers[1]) == 1
        other = float(numbers[1][0] if is_one else np.max(np.abs(numbers[1])))
        value = f"{other:.6g} {estimate.unit}".rstrip()
        how = (
            f"no error is stated, as {how}: it is {value} on elements twice as long; the error by "
            f"the steps alone is +- {estimate.error:.2g}"
        )
        return replace(estimate, error=None, how=how, mesh=inf)
    if size < least:
        size, how = least, f"{how}, whose histories differ more about it"
    time, mesh = (f"{part:.2g} {estimate.unit}".rstrip() for part in (estimate.error, size))
    how = f"time {time}: {estimate.how}; mesh {mesh}: {how}"
    return replace(estimate, error=estimate.error + size, how=how, mesh=size)


def mesh_error(
    numbers: Sequence[np.ndarray], scale: float, order: float
) -> tuple[float | None, str]:
    """The error of the first of numbers on ever coarser meshes, and how it was found.

    None where it does not follow from the meshes. `numbers` (n,) and `scale` in their unit.
    """
    one = distance(numbers[0], numbers[1])
    if one > TOO_FAR * scale:
        return None, "the mesh changes it by more than half"
    if len(numbers) == 2:
        return one, "a mesh twice as coarse"
    two = distance(numbers[1], numbers[2])
    reverses = (
        len(numbers[0]) == 1
        and float((numbers[0] - numbers[1])[0] * (numbers[1] - numbers[2])[0]) < 0.0
    )
    if reverses or one > SHRINKS * two:
        if one > NOTABLE * scale:
            return None, "three meshes do not converge to one value"
        if one >= MUCH_LESS * two:
            return max(one, two), "2 coarser meshes, differences do not shrink"
        return max(one, _share(two, order)), "2 coarser meshes, on either side of this"
    if one == 0.0:
        return 0.0, "2 coarser meshes, no difference"
    power = log2(two / one)
    # a lucky difference: of an error a l + b l^2 that d1 misses, d2 states a third
    least = _share(two, order) if power > order + NEAR else 0.0
    size = max(one / (2.0 ** min(power, order) - 1.0), least)
    # an order near zero gives an error of any size
    return min(size, max(one, two) * 2.0), f"2 coarser meshes, order {power:.2f}"


def _share(two: float, order: float) -> float:
    """Error by the difference of the coarser two of three meshes alone, of the smooth order."""
    ratio: float = 2.0 ** max(order, SMOOTH)
    return two / (ratio * (ratio - 1.0))
