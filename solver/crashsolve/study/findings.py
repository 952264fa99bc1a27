"""Errors of the runs in one watched channel, against the best reference there is.

    error = |x - x_ref| / |x_ref|,   |.| the largest element of a history, or the absolute value

References, best first: an exact or published value of the deck, a results folder, and the runs
themselves by extrapolation. A published value that the runs clearly do not lead to tells of the
model, not of the step, and is only reported. Where the reference is zero the error is absolute.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf, isfinite, nan
from typing import Any

import numpy as np

from crashsolve.study.convergence import (
    NEAR,
    ROUND_OFF,
    Convergence,
    distance,
    examine,
    order_of_errors,
    parting_time,
)
from crashsolve.study.settings import order_of
from crashsolve.study.trials import Trial
from crashsolve.study.watch import PATH, Watch


@dataclass
class Curve:
    """The trials of one method that count, from the longest step to the shortest.

    `sizes` are what the order is measured in: average steps [s], or factors on automatic ones,
    which may be bound by samples most of the time and yet matter in contact.
    """

    method: str
    trials: list[Trial]
    sizes: list[float]
    times: np.ndarray
    values: list[np.ndarray]
    convergence: Convergence


@dataclass
class Finding:
    """One watched channel: its reference, and the error and observed order of each trial.

    `errors` and `orders` are by the folder of the setting; `notes` are for people. `estimate` is
    the least estimated error of a method that converges steadily.
    """

    watch: Watch
    kind: str = ""
    reference: np.ndarray = field(default_factory=lambda: np.empty(0))
    is_absolute: bool = False
    unit: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    orders: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    diverges: bool = False
    estimate: float = inf

    def error(self, trial: Trial) -> float:
        """Error of a trial, NaN when it has none."""
        return self.errors.get(trial.setting.folder, nan)

    def order(self, trial: Trial) -> float:
        """Observed order that ends with a trial, NaN when it has none."""
        return self.orders.get(trial.setting.folder, nan)


def find(watch: Watch, at: int, trials: Sequence[Trial], known: dict[str, Any] | None) -> Finding:
    """Judge the answers number `at` of the trials; `known` is that of a reference folder."""
    finding = Finding(watch)
    problems = {
        t.answers[at]["problem"] for t in trials if t.answers and "problem" in t.answers[at]
    }
    finding.notes += sorted(problems)
    curves = _curves(at, trials)
    if not curves:
        return finding
    finding.unit = str(curves[0].trials[-1].answers[at]["unit"])
    best = _set_reference(finding, curves, known)
    scale = float(np.max(np.abs(finding.reference)))
    finding.is_absolute = scale == 0.0
    for curve in curves:
        _set_errors(finding, curve, scale or 1.0, curve is best)
        _set_orders(finding, curve, curve is best)
        finding.notes.append(_told(finding, curve, scale or 1.0, curve is best))
        finding.diverges |= curve.convergence.diverges
        if curve.convergence.is_steady:
            finding.estimate = min(finding.estimate, curve.convergence.error / (scale or 1.0))
    return finding


def _curves(at: int, trials: Sequence[Trial]) -> list[Curve]:
    """The trials with an answer, by method; without those that took the steps of another."""
    curves = []
    for method in dict.fromkeys(trial.setting.method for trial in trials):
        mine = [
            t
            for t in trials
            if t.setting.method == method
            and (t.is_good and not t.is_same and "value" in t.answers[at])
        ]
        mine.sort(key=lambda trial: -trial.step)
        values = [np.atleast_1d(np.array(t.answers[at]["value"], float)) for t in mine]
        if not mine or len({len(value) for value in values}) > 1 or not len(values[0]):
            continue
        times = np.array(mine[-1].answers[at].get("time", [nan]))
        sizes = _sizes(mine)
        convergence = examine(sizes, values, order_of(method))
        curves.append(Curve(method, mine, sizes, times, values, convergence))
    return curves


def _sizes(trials: list[Trial]) -> list[float]:
    factors = [trial.setting.factor for trial in trials]
    known = [factor for factor in factors if factor is not None]
    return known if len(known) == len(trials) else [trial.step for trial in trials]


def _set_reference(
    finding: Finding, curves: list[Curve], known: dict[str, Any] | None
) -> Curve | None:
    """Choose the reference; returns the curve it comes from, None when it comes from elsewhere."""
    watch, best = finding.watch, min(curves, key=lambda curve: _doubt(curve.convergence))
    if watch.value is not None:
        away = _away(watch, best.convergence)
        if away is None:
            finding.kind, finding.reference = watch.because, np.array([watch.value])
            return None
        finding.notes.append(
            f"the published {watch.value:.6g} is {away:.2g} away from where the runs lead: "
            "no matter of the step, whose error is measured from there"
        )
    elif known is not None:
        given = _at_times(known, curves[0].times)
        if given is not None and len(given) == len(curves[0].values[-1]):
            finding.kind, finding.reference = "file", given
            return None
        reason = known.get("problem", "its samples are at other times")
        finding.notes.append(f"the reference folder does not serve: {reason}")
    finding.reference = best.convergence.value
    finding.kind = "extrapolated" if best.convergence.is_extrapolated else "finest run"
    if len(curves) > 1:
        finding.kind += f" of {best.method}"
    return best


def _away(watch: Watch, found: Convergence) -> float | None:
    """Relative distance of a published value from where the runs lead; None where they lead there.

    An exact value is one whatever the runs say.
    """
    if watch.because == "exact" or not watch.value or not found.is_steady:
        return None
    apart = distance(found.value, np.array([watch.value]))
    # round-off alone can bring the estimate to nothing
    is_elsewhere = apart > 10.0 * max(found.error, ROUND_OFF * abs(watch.value))
    return apart / abs(watch.value) if is_elsewhere else None


def _doubt(convergence: Convergence) -> tuple[bool, float]:
    return convergence.diverges, convergence.error


def _at_times(known: dict[str, Any], times: np.ndarray) -> np.ndarray | None:
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


def _set_errors(finding: Finding, curve: Curve, scale: float, is_best: bool) -> None:
    for trial, value in zip(curve.trials, curve.values, strict=True):
        finding.errors[trial.setting.folder] = distance(value, finding.reference) / scale
    last = curve.trials[-1].setting.folder
    if is_best:
        # the finest run is not its own judge
        error = curve.convergence.error / scale
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


def _told(finding: Finding, curve: Curve, scale: float, is_own: bool) -> str:
    """One method's convergence in words."""
    found = curve.convergence
    if found.diverges:
        return f"{curve.method}: {_divergence_told(finding, curve)}"
    left, words = found.error / scale, [f"{curve.method}: {_order_told(curve, finding)}"]
    if found.stalls is not None:
        step = curve.trials[found.stalls].step
        words.append(
            f"its runs differ by {_size(left, finding)} from step {step:.3g} s on, a floor"
        )
    elif isfinite(left):
        words.append(f"estimated error of its finest run {_size(left, finding)}")
    if not is_own:
        error = finding.error(curve.trials[-1])
        what = "true" if finding.kind == "exact" else f"against the {finding.kind}"
        words.append(f"{what} {_size(error, finding)}")
        if len(curve.trials) > 2 and error > 10.0 * max(left, ROUND_OFF):
            words.append("shorter steps do not lead there: the difference is not the step's")
    return "; ".join(words)


def _divergence_told(finding: Finding, curve: Curve) -> str:
    """From which step and, of a history, from which time on there is no convergence."""
    found, parted = curve.convergence, None
    first = curve.trials[found.stalls or 0]
    if finding.watch.statistic == PATH:
        parted = parting_time(curve.times, curve.values)
    since = "" if parted is None else f", after t = {parted:.6g} s"
    apart = distance(*curve.values[-2:]) / (float(np.max(np.abs(finding.reference))) or 1.0)
    return (
        f"does not converge from step {first.step:.3g} s on{since}; its last two runs differ by "
        f"{_size(apart, finding)}"
    )


def _order_told(curve: Curve, finding: Finding) -> str:
    if len(curve.trials) < 3:
        return "fewer than three runs tell no order"
    seen = [(trial, finding.order(trial)) for trial in curve.trials]
    seen = [(trial, order) for trial, order in seen if isfinite(order)]
    declared = order_of(curve.method)
    if not seen:
        return "no order to be seen: the runs differ by round-off"
    if declared is None:
        return f"order {seen[-1][1]:.2f}"
    near = [(trial, order) for trial, order in seen if abs(order - declared) <= NEAR]
    if near and near[-1] == seen[-1]:
        return f"order {seen[-1][1]:.2f}"
    if near and abs(near[-1][1] - seen[-1][1]) > NEAR:
        step = f"{near[-1][0].step:.3g}"
        return f"order {near[-1][1]:.2f} down to a step of {step} s, then {seen[-1][1]:.2f}"
    return f"order {seen[-1][1]:.2f}, where the method has {declared:g}"


def _size(error: float, finding: Finding) -> str:
    return f"{error:.2g} {finding.unit}".strip() if finding.is_absolute else f"{error:.2g}"


def cheapest(findings: Sequence[Finding], trials: Sequence[Trial], target: float) -> Trial | None:
    """The trial with the least CPU time that meets an error, as do all shorter steps of its method.

    Without that an error that happens to cross zero would pass.
    """
    meeting = []
    for method in dict.fromkeys(trial.setting.method for trial in trials):
        mine = [t for t in trials if t.setting.method == method and t.is_good and not t.is_same]
        for trial in sorted(mine, key=lambda trial: trial.step):
            if not worst(findings, trial) <= target:
                break
            meeting.append(trial)
    return min(meeting, key=lambda trial: trial.cpu_steps, default=None)


def worst(findings: Sequence[Finding], trial: Trial) -> float:
    """Largest relative error of a trial over the channels; infinite when one is unknown."""
    errors = [finding.error(trial) for finding in findings if not finding.is_absolute]
    return max((e if isfinite(e) else inf for e in errors), default=inf)
