"""Errors of the runs in one watched channel, against the best reference there is.

    error = |x - x_ref| / |x_ref|,   |.| the largest element of a history, or the absolute value

References, best first: an exact or published value of the deck, a results folder, and the runs
themselves by extrapolation. A published value to which the runs clearly do not converge shows an
error of the model, not of the step, and is only reported. Where the reference is zero the error is
absolute.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import inf, isfinite, nan

import numpy as np

from crashsolve.output.files import Json
from crashsolve.study.convergence import (
    GROWS,
    NEAR,
    ROUND_OFF,
    Convergence,
    distance,
    divergence_time,
    order_of_errors,
)
from crashsolve.study.curve import (
    Curve,
    Refinement,
    Source,
    curves_of,
    refinement_of,
    refinements_of,
    sort_key,
    sources,
)
from crashsolve.study.methods import order_of
from crashsolve.study.settings import Series
from crashsolve.study.trials import Trial
from crashsolve.study.watch import PATH, Watch

# two answers that are farther apart than this many times both errors contradict each other
EXPLAINED = 3.0
# CPU times [s] below this, and those this near to the least, do not tell which run is cheaper
NOISE, SAME_TIME = 0.05, 1.1


@dataclass
class Finding:
    """One watched channel: its reference, and the error and observed order of each trial.

    `errors`, `orders` and `mesh_orders` are by the folder of the setting; `notes` are for people.
    `estimate` is the least estimated error of a method that converges steadily; `uncertainties`
    are the differences that stay between the runs of a series that does not converge.
    `is_of_one_step` states that errors are those of meshes alone.
    """

    watch: Watch
    kind: str = ""
    reference: np.ndarray = field(default_factory=lambda: np.empty(0))
    is_absolute: bool = False
    unit: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    orders: dict[str, float] = field(default_factory=dict)
    mesh_orders: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    diverges: bool = False
    estimate: float = inf
    uncertainties: dict[Series, float] = field(default_factory=dict)
    is_of_one_step: bool = False

    def error(self, trial: Trial) -> float:
        """Error of a trial over the scale of its channel [1], or as it is where the scale is zero.

        NaN when it has none; no less than the uncertainty of its series.
        """
        error = self.errors.get(trial.setting.folder, nan)
        return (
            error
            if error != error
            else max(error, self.uncertainties.get(trial.setting.series, 0.0))
        )

    def is_uncertain(self, target: float) -> bool:
        """Whether the uncertainty of every series is larger than a wanted error."""
        diverging = not self.is_absolute and self.diverges
        return diverging and all(x > target for x in self.uncertainties.values())

    def order(self, trial: Trial) -> float:
        """Observed order that ends with a trial, NaN when it has none."""
        return self.orders.get(trial.setting.folder, nan)

    def mesh_order(self, trial: Trial) -> float:
        """Observed order of the meshes that ends with a trial, NaN when it has none."""
        return self.mesh_orders.get(trial.setting.folder, nan)


def find(
    watch: Watch,
    at: int,
    trials: Sequence[Trial],
    known: Json | None,
    mesh_order: float | None = None,
    kind: str = "file",
) -> Finding:
    """Judge the answers number `at` of the trials; `known` is that of a reference, of this `kind`.

    `mesh_order` is the declared order of the elements.
    """
    finding = Finding(watch)
    problems = {
        t.answers[at]["problem"] for t in trials if t.answers and "problem" in t.answers[at]
    }
    finding.notes += sorted(problems)
    curves = curves_of(at, trials)
    if not curves:
        return finding
    finding.unit = str(curves[0].trials[-1].answers[at]["unit"])
    refinements = refinements_of(curves, mesh_order)
    known_sources = sources(curves, refinements)
    best = _set_reference(finding, curves, known_sources, known, kind)
    size, around = float(np.max(np.abs(finding.reference))), _size_around(at, curves)
    finding.is_absolute = size <= ROUND_OFF * around
    scale = 1.0 if finding.is_absolute else size
    for curve in curves:
        _set_findings(finding, curve, refinement_of(curve, refinements), best, scale)
    for refinement in refinements:
        _set_mesh_orders(finding, refinement)
    if refinements:
        limit = min(
            refinements,
            key=lambda refinement: sort_key(Source("", refinement.limit, refinement.curves[-1])),
        )
        finding.notes.append(_mesh_reported(finding, limit, scale, mesh_order))
        finding.is_of_one_step = any(refinement.is_of_one_step for refinement in refinements)
    diverging = [curve.convergence.diverges for curve in curves if len(curve.values) > 2]
    if finding.is_absolute and around > 0.0:
        finding.notes = [f"zero to the round-off of its vector, {around:.3g} {finding.unit}"]
        return finding
    # one method may do so by its round-off, or another not by luck
    finding.diverges |= 2 * sum(diverging) >= len(diverging) > 0
    for source in known_sources:
        if source.is_steady:
            finding.estimate = min(finding.estimate, source.convergence.error / scale)
    return finding


def _size_around(at: int, curves: Sequence[Curve]) -> float:
    """Largest magnitude of the vector that the channel belongs to, as far as runs reported it."""
    answers = [trial.answers[at] for curve in curves for trial in curve.trials]
    return max((float(answer.get("size", 0.0)) for answer in answers), default=0.0)


def _set_findings(
    finding: Finding, curve: Curve, refinement: Refinement | None, best: Source | None, scale: float
) -> None:
    """Errors, orders and notes of one curve. Writes: finding."""
    is_own = best is not None and best.finest is curve
    error_left = curve.convergence.error
    if curve.convergence.diverges and isfinite(error_left):
        finding.uncertainties[curve.series] = error_left / scale
    _set_errors(finding, curve, scale, best)
    # the error of a mesh would hide the order of its steps
    by_differences = is_own or refinement is not None
    _set_orders(finding, curve, by_differences)
    if refinement is None or refinement.curves[-1] is curve or curve.convergence.diverges:
        finding.notes.append(_reported(finding, curve, scale, by_differences))


def _set_mesh_orders(finding: Finding, refinement: Refinement) -> None:
    for curve, order in zip(refinement.curves[2:], refinement.convergence.orders, strict=False):
        for trial in curve.trials:
            finding.mesh_orders[trial.setting.folder] = order


def _order_of_meshes(convergence: Convergence, declared: float | None) -> str:
    """The last order, with its largest difference from other orders and from the elements'."""
    others = [p for p in convergence.orders[:-1] if isfinite(p)] + ([declared] if declared else [])
    difference = max((abs(p - convergence.order) for p in others), default=None)
    return (
        f"{convergence.order:.2f}"
        if difference is None
        else f"{convergence.order:.2f} +- {difference:.2f}"
    )


def _mesh_reported(
    finding: Finding, refinement: Refinement, scale: float, order: float | None
) -> str:
    """The error by the mesh in words, by the method that has the least of it."""
    convergence, error_left = refinement.convergence, refinement.limit.error / scale
    errors = [distance(c.convergence.value, finding.reference) / scale for c in refinement.curves]
    errors_in_words = ", ".join(_size(error, finding) for error in errors)
    words = [f"{refinement.name}: {errors_in_words} away"]
    if convergence.diverges:
        words.append("finer meshes do not converge")
    elif isfinite(convergence.order):
        words.append(f"order {_order_of_meshes(convergence, order)} in the length of elements")
    if isfinite(error_left):
        words.append(f"estimated error of the finest mesh {_size(error_left, finding)}")
    if "elout." in finding.watch.name:
        words.append("an element of a finer mesh is a shorter one at the same node")
    return "; ".join(words)


def _set_reference(
    finding: Finding,
    curves: list[Curve],
    known_sources: list[Source],
    known: Json | None,
    kind: str,
) -> Source | None:
    """Choose the reference; returns the source it comes from, None when it comes from elsewhere."""
    watch, best = finding.watch, min(known_sources, key=sort_key)
    if watch.value is not None:
        difference = _distance_from_published(watch, best.convergence)
        if difference is None:
            finding.kind, finding.reference = watch.because, np.array([watch.value])
            return None
        finding.notes.append(
            f"the published {watch.value:.6g} is {difference:.2g} away from the value to which the "
            "runs converge: that is no error of the step, which is measured from that value"
        )
    elif known is not None:
        given = _at_times(known, curves[0].times)
        if given is not None and len(given) == len(curves[0].values[-1]):
            finding.kind, finding.reference = kind, given
            return None
        reason = known.get("problem", "its samples are at other times")
        finding.notes.append(f"the reference folder cannot be used: {reason}")
    _compare_methods(finding, best, known_sources)
    finding.reference = best.convergence.value
    finding.kind = "extrapolated" if best.convergence.is_extrapolated else "finest run"
    if best.convergence.grows:
        finding.kind = "last run before its errors grow"
    if len(curves) > 1:
        finding.kind += f" of {best.name}"
    return best


def _compare_methods(finding: Finding, best: Source, known_sources: Sequence[Source]) -> None:
    """Take as error the distance of another method's limit, where both errors do not explain it.

    Writes: best, finding.
    """
    own, difference, since = best.convergence, 0.0, inf
    size = float(np.max(np.abs(own.value)))
    for other in known_sources:
        gap = np.abs(own.value - other.convergence.value)
        limit = EXPLAINED * (own.error + other.convergence.error) + ROUND_OFF * size
        if other.is_steady and np.max(gap) > limit:
            difference = max(difference, float(np.max(gap)))
            since = min(since, float(other.finest.times[np.argmax(gap > limit)]))
    if difference > 0.0:
        best.convergence, best.apart = replace(own, error=difference), difference
        finding.diverges = True
        share = f"{difference / size:.2g}" if size else f"{difference:.2g} {finding.unit}"
        after = f" after t = {since:.6g} s" if finding.watch.statistic == PATH else ""
        finding.notes.append(
            f"methods converge to values {share} apart{after}, more than their estimated errors "
            "explain: that difference is taken as the error of the reference"
        )


def _distance_from_published(watch: Watch, convergence: Convergence) -> float | None:
    """Relative distance of a published value from the limit of the runs; None within their error.

    An exact value is the reference in any case.
    """
    if watch.because == "exact" or not watch.value or not convergence.is_steady:
        return None
    difference = distance(convergence.value, np.array([watch.value]))
    # the estimate can be zero by round-off alone
    is_elsewhere = difference > 10.0 * max(convergence.error, ROUND_OFF * abs(watch.value))
    return difference / abs(watch.value) if is_elsewhere else None


def _at_times(known: Json, times: np.ndarray) -> np.ndarray | None:
    """The value of a reference, its history at the given times; None when it lacks one."""
    if "value" not in known:
        return None
    values = np.atleast_1d(np.array(known["value"], float))
    if "time" not in known or len(values) < 2:
        return values
    own = np.array(known["time"])
    after = np.clip(np.searchsorted(own, times), 1, len(own) - 1)
    nearest = np.where(times - own[after - 1] < own[after] - times, after - 1, after)
    is_same = np.abs(own[nearest] - times) <= 1e-9 * (own[-1] - own[0])
    return values[nearest] if is_same.all() else None


def _set_errors(finding: Finding, curve: Curve, scale: float, best: Source | None) -> None:
    """Distances from the reference, which comes from the source `best`. Writes: finding."""
    # distances from a run do not show the error of its mesh, and no coarser mesh has a smaller one
    is_blind = best is not None and not best.convergence.is_extrapolated
    blind = best.mesh_error / scale if best is not None and is_blind else 0.0
    # nor that of their method
    if best is not None and curve is best.finest:
        blind += best.apart / scale
    for trial, value in zip(curve.trials, curve.values, strict=True):
        finding.errors[trial.setting.folder] = distance(value, finding.reference) / scale + blind
    last = curve.trials[-1].setting.folder
    if best is not None and best.convergence.grows:
        # it is unknown which of its runs are right
        for trial in curve.trials:
            finding.errors[trial.setting.folder] += best.convergence.error / scale
    elif best is not None and best.finest is curve:
        # the finest run cannot be compared with itself
        error = best.convergence.error / scale
        finding.errors[last] = error if isfinite(error) else nan


def _set_orders(finding: Finding, curve: Curve, is_own: bool) -> None:
    """Orders of errors against another reference, else of the differences of its own runs."""
    if is_own:
        for trial, order in zip(curve.trials[2:], curve.convergence.orders, strict=False):
            finding.orders[trial.setting.folder] = order
        return
    for (one, h1), (two, h2) in pairwise(zip(curve.trials, curve.sizes, strict=True)):
        errors = finding.error(one), finding.error(two)
        is_round_off = not finding.is_absolute and min(errors) < ROUND_OFF
        order = nan if is_round_off else order_of_errors((h1, h2), errors)
        finding.orders[two.setting.folder] = order


def _reported(finding: Finding, curve: Curve, scale: float, is_own: bool) -> str:
    """One method's convergence in words."""
    convergence = curve.convergence
    if convergence.diverges:
        return f"{curve.series.name}: {_divergence_reported(finding, curve, scale)}"
    error_left, words = (
        convergence.error / scale,
        [f"{curve.series.name}: {_order_reported(curve, finding)}"],
    )
    if convergence.stalls is not None:
        step = curve.trials[convergence.stalls].step
        words.append(
            f"its runs differ by {_size(error_left, finding)} from step {step:.3g} s on, a floor"
        )
    elif isfinite(error_left):
        words.append(f"estimated error of its finest run {_size(error_left, finding)}")
    if not is_own:
        error = finding.error(curve.trials[-1])
        what = "true" if finding.kind == "exact" else f"against the {finding.kind}"
        words.append(f"{what} {_size(error, finding)}")
        least = min(finding.error(trial) for trial in curve.trials)
        # its own runs may agree about the wrong value
        if error > max(GROWS * least, error_left, ROUND_OFF):
            words.append("its errors grow as the steps shrink")
        if len(curve.trials) > 2 and error > 10.0 * max(error_left, ROUND_OFF):
            words.append("shorter steps do not reduce that: it is no error of the step")
    return "; ".join(words)


def _divergence_reported(finding: Finding, curve: Curve, scale: float) -> str:
    """From which step and, of a history, from which time on there is no convergence."""
    convergence, diverged_at = curve.convergence, None
    first = curve.trials[convergence.stalls or 0]
    if finding.watch.statistic == PATH:
        diverged_at = divergence_time(curve.times, curve.values)
    since = "" if diverged_at is None else f", after t = {diverged_at:.6g} s"
    if convergence.grows:
        return (
            f"its errors grow as the steps shrink, from step {first.step:.3g} s on{since}: shorter "
            f"ones change it by {_size(convergence.error / scale, finding)}; no run can be trusted "
            "before the cause is found"
        )
    difference = distance(*curve.values[-2:]) / scale
    return (
        f"does not converge from step {first.step:.3g} s on{since}; its last two runs differ by "
        f"{_size(difference, finding)}"
    )


def _order_reported(curve: Curve, finding: Finding) -> str:
    if len(curve.trials) == 1:
        return "the error of a single step is not known"
    if len(curve.trials) < 3:
        return "an order needs three runs or more"
    orders = [(trial, finding.order(trial)) for trial in curve.trials]
    orders = [(trial, order) for trial, order in orders if isfinite(order)]
    declared = order_of(curve.series.method)
    if not orders:
        return "no order visible: the runs differ by round-off, or their steps too little"
    if declared is None:
        return f"order {orders[-1][1]:.2f}"
    near = [(trial, order) for trial, order in orders if abs(order - declared) <= NEAR]
    if near and near[-1] == orders[-1]:
        return f"order {orders[-1][1]:.2f}"
    if near and abs(near[-1][1] - orders[-1][1]) > NEAR:
        step = f"{near[-1][0].step:.3g}"
        return f"order {near[-1][1]:.2f} down to a step of {step} s, then {orders[-1][1]:.2f}"
    return f"order {orders[-1][1]:.2f}, where the method has {declared:g}"


def _size(error: float, finding: Finding) -> str:
    return f"{error:.2g} {finding.unit}".strip() if finding.is_absolute else f"{error:.2g}"


def cheapest(findings: Sequence[Finding], trials: Sequence[Trial], target: float) -> Trial | None:
    """The trial with the least CPU time that meets an error, as do all finer ones of its method.

    Finer: shorter steps on the same mesh, and the shortest steps on finer meshes. Without that an
    error that happens to cross zero would pass.
    """
    meeting = []
    usable = [trial for trial in trials if trial.has_finished and not trial.is_same]
    # from the finest mesh on
    series = sorted({t.setting.series for t in usable}, key=lambda series: -series.mesh)
    missing = set()
    for one in series:
        kind = one._replace(mesh=1)
        own = [trial for trial in usable if trial.setting.series == one]
        passed = []
        for trial in sorted(own, key=lambda trial: trial.step):
            if not worst(findings, trial) <= target:
                break
            passed.append(trial)
        if not passed:
            missing.add(kind)
        if kind not in missing:
            meeting += passed
    return _cheapest_of(meeting, usable)


def _cheapest_of(meeting: Sequence[Trial], usable: Sequence[Trial]) -> Trial | None:
    """The least CPU time; where times do not tell, the first method and its fewest steps."""
    least = min((trial.cpu_steps for trial in meeting), default=0.0)
    fastest = [t for t in meeting if t.cpu_steps <= max(SAME_TIME * least, NOISE)]
    methods = list(dict.fromkeys(trial.setting.series.method for trial in usable))
    return min(
        fastest, default=None, key=lambda t: (methods.index(t.setting.series.method), t.cycles)
    )


def worst(findings: Sequence[Finding], trial: Trial) -> float:
    """Largest relative error of a trial over the channels; infinite when one is unknown."""
    return worst_channel(findings, trial)[0]


def worst_channel(findings: Sequence[Finding], trial: Trial) -> tuple[float, str]:
    """The same, with the name of the channel."""
    errors = [(f.error(trial), f.watch.name) for f in findings if not f.is_absolute]
    largest = max(((e if isfinite(e) else inf, name) for e, name in errors), default=None)
    return largest or (inf, "")
