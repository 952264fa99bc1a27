"""Contacts, and curves of loads and motions, whose peak lies between two samples.

The peak of a contact is that of all steps, the peak of a curve that of its cubics.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crashsolve.channels.series import Series
from crashsolve.channels.statistics._top import heights
from crashsolve.foundation.distinct import distinct
from crashsolve.model.corners import curves_of_time
from crashsolve.model.model import Model

if TYPE_CHECKING:
    from crashsolve.system.engine import Engine

# a range of which the samples show less than this share is missed
SHOWN = 0.5
# of the ups and downs of a curve, and how far it is from samples that miss so many, of its range:
# of waves faster than the samples, these show all sizes and few of the waves
FOLLOWED, FAR = 0.5, 0.05
# and a peak, of which samples at steps show as much (recording/march.py) as long as they are taken
SHOWN_PEAK = 0.9


@dataclass(frozen=True)
class Missed:
    """A contact of which the samples miss the peak; forces [N], times [s]."""

    name: str
    peak: float  # largest normal force of any step
    shown: float  # and of any sample
    impulse: np.ndarray  # (3,) [N s], of all steps
    duration: float  # for how long it touched in all
    touches: int
    bodies: frozenset[str]

    @property
    def shortfall(self) -> float:
        """Part of the peak that the samples do not show [N]."""
        return self.peak - self.shown

    @property
    def is_hidden(self) -> bool:
        """Whether samples show so little of the peak that its run should have more."""
        return self.shown < SHOWN_PEAK * self.peak

    def words(self, interval: float) -> str:
        """The warning of it, for samples `interval` [s] apart."""
        needed = self.duration / max(self.touches, 1) / 20.0
        return (
            f"contact '{self.name}' peaked at {self.peak:.4g} N between samples {interval:.3g} s "
            f"apart, which show {self.shown:.4g} N: largest values and integrals of forces and "
            f"accelerations, HIC and filters miss it; give output.history.interval: {needed:.1g}"
        )


@dataclass(frozen=True)
class MissedCurve:
    """A curve of time of which the samples do not show all."""

    name: str
    range: float  # over the run, in SI
    shown: float  # at samples
    width: float  # time for which it is half as far beyond what is shown as at its peak [s]
    waves: float  # ups and downs at samples over those of the curve [1]
    excess: float  # how far it leaves what samples and their parabolas show, over its range [1]

    @property
    def is_hidden(self) -> bool:
        """Whether samples miss most of it."""
        is_faster = self.waves < FOLLOWED and self.excess > FAR
        return self.shown < SHOWN * self.range or is_faster

    def words(self, interval: float) -> str:
        """The warning of it, for samples `interval` [s] apart."""
        what = f"which show {self.shown:.4g}"
        if self.shown >= SHOWN * self.range:
            what = f"which show {100.0 * self.waves:.3g} % of its ups and downs"
        return (
            f"curve '{self.name}' ranges over {self.range:.4g} (SI) between samples {interval:.3g} "
            f"s apart, {what}: largest values and integrals of forces, "
            "accelerations and velocities, HIC and filters miss it; give output.history.interval: "
            f"{self.width / 20.0:.1g}"
        )


def missed_curves(engine: Engine, history: Path) -> list[MissedCurve]:
    """Curves of loads and motions of which the samples of a finished run do not show all."""
    model, missed = engine.model, list[MissedCurve]()
    firsts = sorted(curves_of_time(model))
    if not firsts:
        return missed
    import h5py

    with h5py.File(history) as file:
        times = file["glstat"]["time"][:]
    # rows that are reserved and were not written
    times = times[np.isfinite(times)]
    names = {k: name for name, k in model.curve_names.items()}
    for first in firsts:
        points = model.curves[first : model.curves[first]["last"] + 1]
        # an equilibrium moves drivers by curves of its own
        one = _missed_curve(names[first], points, times) if first in names else None
        if one is not None:
            missed.append(one)
    return missed


def _missed_curve(name: str, points: np.ndarray, times: np.ndarray) -> MissedCurve | None:
    """What samples at `times` (n,) do not show of a curve; None where that is nothing."""
    x = np.clip(points["x"], times[0], times[-1])
    t = distinct(np.concatenate([x, 0.5 * (x[:-1] + x[1:])]))
    true, shown = _values(points, t), _values(points, times)
    span = float(np.ptp(true))
    excess = max(_excess(t, sign * true, times, sign * shown) for sign in (1.0, -1.0))
    if not excess > 0.0 or not span > 0.0:
        return None
    beyond = np.maximum(true - shown.max(), shown.min() - true)
    width = float((np.gradient(t) * (beyond > 0.5 * beyond.max())).sum())
    waves = float(np.abs(np.diff(shown)).sum() / np.abs(np.diff(true)).sum())
    if waves < FOLLOWED and np.ptp(shown) >= SHOWN * span:
        # of a sine, the time of one up and down
        width = 2.0 * span * float(times[-1] - times[0]) / float(np.abs(np.diff(true)).sum())
    return MissedCurve(name, span, float(np.ptp(shown)), width, waves, excess / span)


def _excess(t: np.ndarray, true: np.ndarray, times: np.ndarray, shown: np.ndarray) -> float:
    """How far a curve, `true` (m,) at `t` (m,), rises above its samples on either side, `shown`
    (n,) at `times` (n,), and the parabolas by them.
    """
    series = Series(times, shown)
    highest = heights(series)
    k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    return float(np.max(true - np.maximum(highest[k], highest[k + 1]), initial=0.0))


def _values(points: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Values of a curve (n,) at times (n,), at its ends for those outside."""
    x, c = points["x"], points["c"]
    at = np.clip(times, x[0], x[-1])
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    s = at - x[k]
    value: np.ndarray = c[k, 0] + s * (c[k, 1] + s * (c[k, 2] + s * c[k, 3]))
    return value


def missed_contacts(engine: Engine, history: Path) -> list[Missed]:
    """Contacts whose largest normal force no sample shows wholly, by the history of a finished
    run.
    """
    model, missed = engine.model, list[Missed]()
    if not model.contacts:
        return missed
    import h5py

    saved = engine.state.card_history[int(engine.clock["current"])]
    with h5py.File(history) as file:
        shown = file["rcforc"]["normal"][:]
        names = list(file["rcforc"]["ids"].asstr())
    shown = np.nanmax(shown, axis=0, initial=0.0)
    bodies = _bodies(model)
    for k, name in enumerate(model.contacts):
        peak, sampled = float(saved["peak_normal"][k]), float(shown[names.index(name)])
        if sampled < peak:
            missed.append(
                Missed(
                    name,
                    peak,
                    sampled,
                    saved["impulse"][k].copy(),
                    float(saved["duration"][k]),
                    int(saved["touches"][k]),
                    bodies.get(name, frozenset()),
                )
            )
    return missed


def _bodies(model: Model) -> dict[str, frozenset[str]]:
    """Bodies that each contact card may touch."""
    bodies_of: dict[str, set[str]] = {}
    for group in model.contact_groups:
        p = group.parameters
        for elements, side in ((group.elements_a, p["a"]), (group.elements_b, p["b"])):
            for card, node in zip(p["card"], elements["node"][side], strict=True):
                bodies_of.setdefault(model.contacts[int(card)], set()).add(model.bodies[int(node)])
    return {name: frozenset(some - {"ground"}) for name, some in bodies_of.items()}
