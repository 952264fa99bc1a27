"""Errors by the cubics of formulas, which no run shows, as all runs of a deck have the same ones.

    values          the tolerance that the cubics keep (curves/formula.py)
    accelerations   of motions that drive joints: h^2 f'''' / 12, which is the error of f'' at the
                    ends of a cubic, with the change of f''' from one cubic to the next: the
                    largest, or that at the moment that a number reads

Accelerations and reactions of a driver are those of the bodies that joints connect with it; others
follow positions and velocities. Consequence to test: a driven sine is right within its error.
"""

import re
from dataclasses import replace
from importlib import import_module
from types import ModuleType

import numpy as np

from crashsolve.channels.statistic import requested_moment
from crashsolve.deck.reading.deck import Deck
from crashsolve.estimate.error import Estimate
from crashsolve.model.motions import derivatives_read

# words of channels that read the acceleration of a motion
SECOND = ("acceleration", "force", "moment", "torque")
# and of those of springs, which read positions and velocities
SPRING = "deforc."
BODY = re.compile(r"\brbdout\.([\w-]+)\.")
# breakpoints, values and slopes of a formula, and the tolerance kept
Samples = tuple[np.ndarray, np.ndarray, np.ndarray, float]
# breakpoints on both sides of a moment that count
NEAR = 3


def with_formulas(estimate: Estimate, deck: Deck) -> Estimate:
    """An estimate that is no smaller than what the cubics of formulas miss."""
    curves = deck.entries["curves"].items()
    formulas = {name: entry.card for name, entry in curves if entry.type == "formula"}
    if not formulas or not estimate.error:
        return estimate
    # a run without formulas does not import them
    formula = import_module(type(next(iter(formulas.values()))).__module__)
    motions = derivatives_read(deck)
    # the cubics of the run (model/build.py), which are at hand
    kept = {name: formula.sample(card, motions.get(name, 0)) for name, card in formulas.items()}
    share, what = max(samples[3] for samples in kept.values()), "values"
    if _reads_accelerations(estimate.watch.channels[0], deck):
        moment = _moment(estimate.watch.statistic, deck)
        driving = [
            _driving_error(formula, kept[n], motions[n], moment) for n in motions if n in kept
        ]
        if driving and max(driving) > share:
            share, what = max(driving), "accelerations"
    if estimate.error >= share * estimate.scale:
        return estimate
    how = f"{estimate.how}; formulas within {share:.0e} of their {what}"
    return replace(estimate, error=share * estimate.scale, how=how)


def _driving_error(
    formula: ModuleType, samples: Samples, derivatives: int, moment: float | None
) -> float:
    """Error of the acceleration that a formula prescribes, over its largest."""
    x, y, slopes, tolerance = samples
    if derivatives == 2:
        return acceleration_error(x, y, slopes, moment)
    # of a velocity that is given, f' is an acceleration
    return float(formula.motion_tolerance(tolerance)) if derivatives else 0.0


def acceleration_error(
    x: np.ndarray, y: np.ndarray, slopes: np.ndarray, moment: float | None
) -> float:
    """Error of f'' of cubics with these breakpoints, values and slopes (n,), over the largest; at
    a moment, that of the cubics there.
    """
    h, rise = np.diff(x), np.diff(y)
    first = (6.0 * rise / h - 4.0 * slopes[:-1] - 2.0 * slopes[1:]) / h
    last = (-6.0 * rise / h + 2.0 * slopes[:-1] + 4.0 * slopes[1:]) / h
    largest = float(max(np.abs(first).max(), np.abs(last).max()))
    fourth = np.abs(np.diff((last - first) / h)) / (0.5 * (h[1:] + h[:-1]))
    errors = np.maximum(h[1:], h[:-1]) ** 2 * fourth / 12.0
    if moment is not None:
        at = min(max(int(np.searchsorted(x, moment)) - 1, 0), len(errors))
        errors = errors[max(at - NEAR, 0) : at + NEAR]
    return float(errors.max(initial=0.0)) / largest if largest else 0.0


def _moment(statistic: str, deck: Deck) -> float | None:
    """The time [s] that a number reads; None for those of a whole history."""
    return deck.control.end_time if statistic == "final" else requested_moment(statistic)


def _reads_accelerations(channel: str, deck: Deck) -> bool:
    """Whether a channel reads accelerations that a driver prescribes."""
    if SPRING in channel or not any(word in channel for word in SECOND):
        return False
    bodies = set(BODY.findall(channel))
    return not bodies or not bodies <= deck.entries["bodies"].keys() - _driven_bodies(deck)


def _driven_bodies(deck: Deck) -> set[str]:
    """Bodies that joints connect, directly or through others, with a driver."""
    cards = {name: entry.card for name, entry in deck.entries["joints"].items()}
    groups: list[tuple[set[str], bool]] = []
    for card in cards.values():
        of = [
            card,
            *(cards[n] for f in ("joint", "first", "second") if (n := _name(card, f)) in cards),
        ]
        group = {n for one in of for f in ("a", "b", "body") if (n := _name(one, f))} - {"ground"}
        is_driven = any(_name(card, f) for f in ("curve", "velocity", "acceleration"))
        apart = [one for one in groups if not one[0] & group]
        for others, driven in (one for one in groups if one[0] & group):
            group, is_driven = group | others, is_driven or driven
        groups = [*apart, (group, is_driven)]
    # a part of a body moves with it
    bodies = deck.entries["bodies"].items()
    parts = {name for name, entry in bodies if getattr(entry.card, "part_of", None)}
    return set().union(parts, *(group for group, is_driven in groups if is_driven))


def _name(card: object, field: str) -> str:
    """A name in a field of a card; empty where it has none."""
    value = getattr(card, field, None)
    return value if isinstance(value, str) else ""
