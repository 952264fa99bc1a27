"""The settings of a study: integrators x steps, or x tolerances where the method chooses its step.

The automatic step is made longer and shorter by its two bounds, the share of the critical step and
the longest step.
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

from crashsolve.deck.read import Deck
from crashsolve.foundation.errors import DeckError

FACTORS = (4.0, 2.0, 1.0, 1 / 2, 1 / 4, 1 / 8)
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
AUTO = "auto"
# label, overrides, factor on the automatic step
Words = tuple[str, dict[str, str], float | None]


@dataclass(frozen=True)
class Setting:
    """One run of a study: a method, its setting in words, and what that changes in the deck.

    `factor` is that on the automatic step, where this is what is changed.
    """

    method: str
    label: str
    overrides: dict[str, str]
    factor: float | None = None

    @property
    def folder(self) -> str:
        """Name of the folder of the run."""
        label = self.label.replace("/", "_over_").replace("*", "_times_")
        return f"{self.method}_{label.replace(' ', '_')}"


def settings(
    deck: Deck, methods: Sequence[str], steps: str | None, tolerances: str | None
) -> list[Setting]:
    """All settings, of each method from the longest step on. Raises DeckError for a wrong word."""
    found = []
    for method in methods or [deck.control.integrator]:
        for label, overrides, factor in _of_method(deck, method, steps, tolerances):
            changes = {"control.integrator": method, **overrides}
            found.append(Setting(method, label, changes, factor))
    return found


def order_of(method: str) -> float | None:
    """Declared order of a method; None when it declares none."""
    return getattr(_module(method), "ORDER", None)


def chooses_its_step(method: str) -> bool:
    """Whether a method chooses its steps by a tolerance, as those of stages do."""
    return hasattr(_module(method), "STAGES")


def _module(method: str) -> ModuleType | None:
    try:
        return importlib.import_module(f"crashsolve.integrators.{method}")
    except ModuleNotFoundError:
        # a run with it will say so
        return None


def _of_method(deck: Deck, method: str, steps: str | None, tolerances: str | None) -> list[Words]:
    """One method's settings."""
    step = deck.control.step
    if chooses_its_step(method) and (tolerances or (not steps and step == AUTO)):
        words = _numbers("--tolerances", tolerances) if tolerances else TOLERANCES
        return [_within(t) for t in sorted(map(float, words), reverse=True)]
    if steps:
        given = _numbers("--steps", steps, AUTO)
        numbers = sorted((float(h) for h in given if h != AUTO), reverse=True)
        return [_automatic(deck, 1.0)] * (AUTO in given) + [_fixed(h) for h in numbers]
    if step == AUTO:
        return [_automatic(deck, factor) for factor in FACTORS]
    return [_fixed(float(step) * factor) for factor in FACTORS]


def _within(tolerance: float) -> Words:
    return (
        f"tolerance {tolerance:g}",
        {"control.tolerance": repr(tolerance), "control.step": AUTO},
        None,
    )


def _fixed(step: float) -> Words:
    # with its unit: bare numbers of the deck may be in another
    return f"{step:.6g}", {"control.step": f"{step!r} s"}, None


def _automatic(deck: Deck, factor: float) -> Words:
    """The automatic step with both bounds times a factor."""
    if factor == 1.0:
        return AUTO, {"control.step": AUTO}, factor
    control = deck.control
    span = control.end_time - control.start_time
    # a step never passes a sample
    longest = min(control.step_max or span, deck.output.history.interval or span / 1000) or 1.0
    overrides = {
        "control.step": AUTO,
        "control.safety": repr(min(control.safety * factor, 1.0)),
        "control.step_max": f"{longest * factor!r} s",
    }
    label = f"auto*{factor:g}" if factor > 1.0 else f"auto/{1 / factor:g}"
    return label, overrides, factor


def _numbers(option: str, text: str, *words: str) -> list[str]:
    """The entries of a comma-separated list: positive numbers, or the words. Raises DeckError."""
    entries = [entry.strip() for entry in text.split(",")]
    for entry in entries:
        if entry not in words and not _is_positive(entry):
            advice = f"write {option} 1e-3,5e-4" + "".join(f",{word}" for word in words)
            message = f"'{entry}' is not a positive number"
            raise DeckError(f"{option} {text}", None, None, "", message, advice)
    return list(dict.fromkeys(entries))


def _is_positive(text: str) -> bool:
    try:
        return 0.0 < float(text) < float("inf")
    except ValueError:
        return False
