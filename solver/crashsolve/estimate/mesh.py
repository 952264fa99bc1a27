"""The error by the mesh: a run on elements twice as long, and one on elements four times as long.

    d1 = |x1 - x2|,  d2 = |x2 - x4|,  p their order as in a study, no more than the elements' q
    three meshes        error = d1 / (2^p - 1), at least d2 / (2^s (2^s - 1)), s = max(q, 2)
    of opposite signs   error = d1, at least d2 / (2^s (2^s - 1)), where d1 < d2 / 4; else d2
    two meshes          error = d1, that of order 1: contact and yield have no more
    at a moment         at least a quarter of the root mean square of x1 - x2 about that moment:
    of an extreme       histories that cross there agree by chance; about an extreme, while the
                        history is in the half of its range that ends there

No error follows from the meshes where x1 and x2 differ by more than half the scale of the number,
or where d1 is no smaller than d2, or of the other sign, and more than a twentieth of the scale: the
message then names folding, softening and perforation. Where numbers of elements are not powers of
2, the lengths of elements are in ratios between 1.5 and 2, which take the place of 2. No run is
compared on a mesh on which a node or trace with a name is elsewhere. Consequence to test:
x = 1 + l^q gives the error l^q.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isfinite, log
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistic import requested_moment
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.run_cards.statistic import PATH
from crashsolve.estimate.companion import BudgetExceeded, Companions
from crashsolve.estimate.error import Estimate
from crashsolve.foundation.errors import CrashsolveError, SolverError
from crashsolve.model.model import Model
from crashsolve.recording.samples import Samples
from crashsolve.study.convergence import NEAR, SHRINKS, distance, observed_order
from crashsolve.study.meshes import Coarser, coarser, has_mesh
from crashsolve.study.watch import Watch

if TYPE_CHECKING:
    from crashsolve.elements.shells.layout import DiscretisedShell

FACTORS = (2, 4)
# order of elements without contact and yield, and of shells, which have them
SMOOTH, CRUSHED = 2.0, 1.0
# shares of the scale
TOO_FAR, NOTABLE = 0.5, 0.05
# of the model's size: round-off of two meshes with the same node
SAME_POSITION = 1e-6
# share of its area by which a part on some elements of a mesh may change: chords of eight elements
# around miss 2.6 % of a circle, and a border that moves by half of one in ten changes it by 5 %
SAME_AREA = 0.05
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
    """Runs on coarser meshes, from elements twice as long on, and why there are no more.

    `lengths` are those of elements, over the run's; `kept` are numbers of elements that stay.
    """

    runs: list[Samples]
    problem: str = ""
    lengths: list[float] = field(default_factory=lambda: [1.0])
    kept: dict[str, int] = field(default_factory=dict)

    @property
    def remarks(self) -> list[str]:
        """What the error by the mesh leaves out, and why there is none."""
        if self.problem or not self.runs or not self.kept:
            return [self.problem] if self.problem else []
        numbers = ", ".join(f"{path} of {n}" for path, n in self.kept.items())
        return [f"coarser meshes keep {numbers}: errors by these numbers are not covered"]


def coarse_runs(
    deck: Deck,
    start: Callable[[Deck], tuple[Companions, Model]],
    own: Callable[[], Model],
    coarseness: float,
    budget: float = inf,
) -> Meshes:
    """Runs of a deck on coarser meshes for at most `budget` [s] of CPU. Raises Abandoned.

    `start` gives the companions of another deck, whose channels are columns of its own, and its
    model; `own` that of this deck.
    """
    meshes = Meshes([])
    if not has_mesh(deck):
        return meshes
    for factor in FACTORS:
        try:
            changes = _changes(deck, factor, meshes)
            companions, model = start(_coarse(deck, changes.overrides))
            _check_positions(model, own)
            companions.budget = budget
            meshes.runs.append(companions.run(coarseness))
            meshes.lengths.append(changes.ratio)
            meshes.kept = meshes.kept or changes.kept
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


def _changes(deck: Deck, factor: int, meshes: Meshes) -> Coarser:
    """Those of elements `factor` times as long. Raises ValueError where there are no others."""
    changes = coarser(deck, factor)
    if not changes.ratio > meshes.lengths[-1]:
        raise ValueError("some elements cannot be longer")
    return changes


def _check_positions(model: Model, own: Callable[[], Model]) -> None:
    """Raises ValueError where a node or trace of a coarser mesh, or a part, is elsewhere."""
    coarse = _shells(model)
    if not any(part.named or part.traced or part.mesh.own is not None for part in coarse.values()):
        return
    fine = _shells(own())
    for name, part in coarse.items():
        names = [node.name for node in (*part.card.nodes, *part.card.traces)]
        own_points = fine[name].mesh.points[[*fine[name].named, *fine[name].traced]]
        moved = part.mesh.points[[*part.named, *part.traced]] - own_points
        for node, gap in zip(names, np.linalg.norm(moved, axis=1), strict=True):
            if gap > SAME_POSITION * model.size:
                raise ValueError(f"node '{node}' of part '{name}' is elsewhere on a coarser mesh")
        is_shared = part.mesh.own is not None
        if is_shared and abs(part.area.sum() / fine[name].area.sum() - 1.0) > SAME_AREA:
            raise ValueError(f"part '{name}' ends elsewhere on a coarser mesh")


def _shells(model: Model) -> "dict[str, DiscretisedShell]":
    return model.elements.parts if model.elements is not None else {}


def _coarse(deck: Deck, overrides: dict[str, str]) -> Deck:
    """The deck on a coarser mesh, with the control and output that it has by now."""
    given = deck.given | overrides
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
    estimate: Estimate,
    numbers: Sequence[np.ndarray],
    deck: Deck,
    lengths: Sequence[float],
    least: float = 0.0,
) -> Estimate:
    """An estimate with the error by the mesh in it, `least` or more; `numbers` of this mesh and
    coarser ones, with the `lengths` of their elements over this one's.
    """
    is_unknown = estimate.steps == inf
    if estimate.error is None and not is_unknown:
        return estimate
    # a run without a mesh needs no settings of studies
    from crashsolve.study.settings import order_of_mesh

    order = order_of_mesh(deck, CRUSHED) or CRUSHED
    size, how = mesh_error(numbers, estimate.scale, order, lengths)
    if size is None:
        is_one = len(numbers[1]) == 1
        other = float(numbers[1][0] if is_one else np.max(np.abs(numbers[1])))
        value = f"{other:.6g} {estimate.unit}".rstrip()
        steps = "not known" if is_unknown else f"+- {estimate.error:.2g}"
        how = (
            f"no error is stated, as {how}: it is {value} on elements twice as long; the error by "
            f"the steps alone is {steps}"
        )
        return replace(estimate, error=None, how=how, mesh=inf)
    if size < least:
        size, how = least, f"{how}, whose histories differ more about it"
    by_time = 0.0 if is_unknown else estimate.error or 0.0
    time, mesh = (f"{part:.2g} {estimate.unit}".rstrip() for part in (by_time, size))
    time = estimate.how if is_unknown else f"{time}: {estimate.how}"
    how = f"time {time}; mesh {mesh}: {how}"
    return replace(estimate, error=by_time + size, how=how, mesh=size)


def mesh_error(
    numbers: Sequence[np.ndarray],
    scale: float,
    order: float,
    lengths: Sequence[float] = (1.0, 2.0, 4.0),
) -> tuple[float | None, str]:
    """The error of the first of numbers on ever coarser meshes, and how it was found.

    None where it does not follow from the meshes. `numbers` (n,) and `scale` in their unit,
    `lengths` of elements over those of the first mesh.
    """
    one = distance(numbers[0], numbers[1])
    if one > TOO_FAR * scale:
        return None, "the mesh changes it by more than half"
    if len(numbers) == 2:
        return one / (lengths[1] - 1.0), "a mesh twice as coarse"
    two = distance(numbers[1], numbers[2])
    reverses = (
        len(numbers[0]) == 1
        and float((numbers[0] - numbers[1])[0] * (numbers[1] - numbers[2])[0]) < 0.0
    )
    # of order 0 differences are as the logarithms of these ratios
    unequal = log(lengths[1]) / log(lengths[2] / lengths[1])
    if reverses or one > SHRINKS * two * unequal:
        if one > NOTABLE * scale:
            return None, "three meshes do not converge to one value"
        if one >= MUCH_LESS * two:
            return max(one, two), "2 coarser meshes, differences do not shrink"
        return max(one, _share(two, order, lengths)), "2 coarser meshes, on either side of this"
    if one == 0.0:
        return 0.0, "2 coarser meshes, no difference"
    power = observed_order(lengths[2::-1], (two, one))
    seen = f"order {power:.2f}" if isfinite(power) else "no order"
    power = power if isfinite(power) else inf
    # a lucky difference: of an error a l + b l^2 that d1 misses, d2 states a third
    least = _share(two, order, lengths) if power > order + NEAR else 0.0
    size = max(one / (lengths[1] ** min(power, order) - 1.0), least)
    # an order near zero gives an error of any size
    return min(size, max(one, two) * 2.0), f"2 coarser meshes, {seen}"


def _share(two: float, order: float, lengths: Sequence[float]) -> float:
    """Error by the difference of the coarser two of three meshes alone, of the smooth order."""
    power = max(order, SMOOTH)
    share: float = two / (lengths[2] ** power - lengths[1] ** power)
    return share
