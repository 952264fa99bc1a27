"""What happens between samples is part of the error of numbers that are made of samples.

    largest normal force of a contact:                     peak - shown at least
    largest or least value of a force of a missed contact: + peak - shown
    integral of it:                                                + |impulse - integral|
    acceleration of a body that it strikes:                        + (peak - shown) / m

A force in a joint, spring or section may miss as much as the contact does. Of HIC, filters and the
like of such a body, of sensors and of stored energies nothing can be said, nor of forces and
velocities where a load or a prescribed motion has its peak between samples. Consequence to test: no
extreme or integral across a touch that lies between two samples has an error below its own size.

Where a body moves between samples as none of them shows, extremes and integrals of its motion and
of all forces but those of contacts have no error, and those of positions a larger one.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from crashsolve.estimate.error import Estimate


class Missed(Protocol):
    """A contact of which the samples miss the peak (simulation/missed.py)."""

    @property
    def name(self) -> str: ...
    @property
    def peak(self) -> float: ...
    @property
    def shown(self) -> float: ...
    @property
    def impulse(self) -> np.ndarray: ...
    @property
    def bodies(self) -> frozenset[str]: ...

    @property
    def shortfall(self) -> float:
        """Part of the peak that the samples do not show [N]."""

    @property
    def is_hidden(self) -> bool:
        """Whether that is most of it."""


class MissedCurve(Protocol):
    """A curve of a load or a motion that leaves what samples show, by `excess` of its range."""

    @property
    def name(self) -> str: ...
    @property
    def excess(self) -> float: ...

    @property
    def is_hidden(self) -> bool:
        """Whether samples miss most of it."""


class MissedMotion(Protocol):
    """A body that moves between samples as they do not show (simulation/missed_motions.py)."""

    @property
    def name(self) -> str: ...
    @property
    def start(self) -> float: ...
    @property
    def end(self) -> float: ...
    @property
    def displacement(self) -> float: ...


OF_SAMPLES = ("max", "min", "abs_max", "argmax", "argmin", "integral", "mean", "rms")
# of them, those in the unit of the channel
OF_SIZE = ("max", "min", "abs_max", "mean", "rms")
# functions whose value at any time is made of samples before it
RUNNING_FUNCTIONS = re.compile(r"\b(hic|si|clip|cfc|integral|bric)\(")
FORCES = re.compile(r"\b(jntforc|deforc|secforc)\.[\w-]+\.(force|axial|shear)\b")
MOVED = re.compile(r"\brbdout\.([\w-]+)\.acceleration\b")
SENSED = re.compile(r"\b(nodout\.|glstat\.model\.energy\.\w+_stored)")
# forces, lengths and angles between bodies; contacts have peaks of all steps
BETWEEN = re.compile(r"\b(jntforc|deforc|secforc|disbout|bndout|tyrout|beltout|hinge)\.")
BODY = re.compile(r"\brbdout\.([\w-]+)\.")
POSITIONS = re.compile(r"\.(position|vector|length|elongation|displacement|angle)\b")
FORCES_AND_RATES = re.compile(
    r"(force|moment|torque|axial|shear|rate|velocity|acceleration|energy)\b"
)
# what a load or a motion between samples changes there; contacts have peaks of all steps
LOADED = re.compile(r"(force|moment|torque|normal|velocity|acceleration|energy)\b|\bnodout\.")

# and what follows it without delay, as motions and forces of springs do not
AT_ONCE = re.compile(r"acceleration|\bjntforc\.|\bsecforc\.")


def with_missed_curves(
    estimates: Sequence[Estimate], curves: Sequence[MissedCurve]
) -> list[Estimate]:
    """Estimates, without errors of what is made of samples where `curves` peak between them."""
    hidden = [curve for curve in curves if curve.is_hidden]
    if hidden:
        return [_with_missed_curves(e, hidden[0].name) for e in estimates]
    worst = max(curves, key=lambda curve: curve.excess, default=None)
    return [_with_excess(e, worst) for e in estimates] if worst else list(estimates)


def _with_missed_curves(estimate: Estimate, curve: str) -> Estimate:
    text = " ".join(estimate.watch.channels)
    is_of_samples = estimate.watch.statistic in OF_SAMPLES or RUNNING_FUNCTIONS.search(text)
    if estimate.error is None or not is_of_samples or not LOADED.search(text):
        return estimate
    how = f"not estimated: curve '{curve}' has its peak between samples"
    return replace(estimate, error=None, how=how)


def _with_excess(estimate: Estimate, curve: MissedCurve) -> Estimate:
    """The estimate of an extreme of what follows a load at once, as if the load made all of it."""
    is_extreme = estimate.watch.statistic in ("max", "min", "abs_max")
    missed = curve.excess * estimate.scale
    if not is_extreme or estimate.error is None or missed <= estimate.error:
        return estimate
    if not AT_ONCE.search(" ".join(estimate.watch.channels)):
        return estimate
    how = f"{estimate.how}; curve '{curve.name}' between samples {missed:.2g} {estimate.unit}"
    return replace(estimate, error=estimate.error + missed, how=how.rstrip())


def with_missed_motions(
    estimates: Sequence[Estimate], motions: Sequence[MissedMotion]
) -> list[Estimate]:
    """Estimates, without errors of what is made of samples that miss the motion of a body."""
    return [_with_missed_motions(e, motions) if motions else e for e in estimates]


def _with_missed_motions(estimate: Estimate, motions: Sequence[MissedMotion]) -> Estimate:
    text = " ".join(estimate.watch.channels)
    is_of_samples = estimate.watch.statistic in OF_SAMPLES or RUNNING_FUNCTIONS.search(text)
    if estimate.error is None or not is_of_samples:
        return estimate
    during = estimate.watch.during
    if during:
        motions = [m for m in motions if m.end > during[0] and m.start < during[1]]
    own = [m for m in motions if m.name in BODY.findall(text)]
    if BETWEEN.search(text) or SENSED.search(text):
        own = own or list(motions)
    if not own:
        return estimate
    others = FORCES_AND_RATES.search(text) or RUNNING_FUNCTIONS.search(text)
    if POSITIONS.search(text) and not others and estimate.watch.statistic in OF_SIZE:
        worst = max(own, key=lambda m: m.displacement)
        missed = f"{worst.displacement:.2g} {estimate.unit}".rstrip()
        how = f"{estimate.how}; body '{worst.name}' between samples {missed}"
        return replace(estimate, error=estimate.error + worst.displacement, how=how)
    how = f"not estimated: body '{own[0].name}' moves between samples as none of them shows"
    return replace(estimate, error=None, how=how)


def with_missed_contacts(
    estimates: Sequence[Estimate], missed: Sequence[Missed], mass: dict[str, float]
) -> list[Estimate]:
    """Estimates, with the errors by samples of the contacts `missed`; `mass` [kg] of bodies by
    name.
    """
    hidden = [m for m in missed if m.is_hidden]
    known = [_with_known_peak(estimate, missed) for estimate in estimates]
    return [_with_missed_contacts(e, hidden, mass) for e in known] if hidden else known


def _with_known_peak(estimate: Estimate, missed: Sequence[Missed]) -> Estimate:
    """The estimate of a largest normal force, with all that steps had more than samples."""
    names = [f"rcforc.{m.name}.normal" for m in missed]
    text, during = estimate.watch.channels[0].strip(), estimate.watch.during
    if estimate.error is None or during or estimate.watch.statistic not in ("max", "abs_max"):
        return estimate
    shortfall = missed[names.index(text)].shortfall if text in names else 0.0
    return replace(estimate, error=max(estimate.error, shortfall))


def _with_missed_contacts(
    estimate: Estimate, missed: Sequence[Missed], mass: dict[str, float]
) -> Estimate:
    """The estimate, enlarged by the peaks that its channels miss between samples, or withdrawn."""
    text, statistic = " ".join(estimate.watch.channels), estimate.watch.statistic
    is_running = bool(RUNNING_FUNCTIONS.search(text))
    if estimate.error is None or (statistic not in OF_SAMPLES and not is_running):
        return estimate
    worst = max(missed, key=lambda m: float(m.shortfall))
    named = [m for m in missed if re.search(rf"\brcforc\.{re.escape(m.name)}\.", text)]
    if named and "impulse" not in text and "peak_" not in text:
        return _of_contact(estimate, named[0], text, statistic)
    if FORCES.search(text) and not is_running:
        return _with_shortfall(estimate, worst.shortfall, worst)
    changes = _changes_of_bodies(text, missed, mass)
    if changes and not is_running and statistic in ("max", "min", "abs_max"):
        return _with_shortfall(estimate, max(changes), worst)
    if changes or SENSED.search(text) or (is_running and MOVED.search(text) is None):
        how = f"not estimated: contact '{worst.name}' peaked at {worst.peak:.3g} N between samples"
        return replace(estimate, error=None, how=how)
    return estimate


def _changes_of_bodies(text: str, missed: Sequence[Missed], mass: dict[str, float]) -> list[float]:
    """Accelerations [m/s^2] by missed peaks, of the bodies whose motion is in an expression."""
    struck = {name for name in MOVED.findall(text) for m in missed if name in m.bodies}
    return [m.shortfall / mass[name] for name in struck for m in missed if name in m.bodies]


def _of_contact(estimate: Estimate, own: Missed, text: str, statistic: str) -> Estimate:
    """The estimate of a number of the very contact whose peak lies between samples."""
    if statistic == "integral" and estimate.value is not None:
        component = re.search(r"\.force\.([xyz])", text)
        if component:
            true = float(own.impulse["xyz".index(component.group(1))])
        else:
            true = float((own.impulse**2).sum() ** 0.5)
        return _with_shortfall(estimate, abs(true - estimate.value), own)
    if re.search(r"\.(normal|tangential|force)\b", text) and statistic in ("max", "min", "abs_max"):
        return _with_shortfall(estimate, own.shortfall, own)
    how = f"not estimated: it peaked at {own.peak:.3g} N between samples"
    return replace(estimate, error=None, how=how)


def _with_shortfall(estimate: Estimate, shortfall: float, own: Missed) -> Estimate:
    missed = f"{shortfall:.2g} {estimate.unit}".rstrip()
    how = f"{estimate.how}; contact '{own.name}' between samples {missed}"
    return replace(estimate, error=(estimate.error or 0.0) + shortfall, how=how)
