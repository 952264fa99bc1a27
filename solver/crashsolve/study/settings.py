"""The settings of a study: integrators x steps or tolerances x meshes x descriptions x a field.

Tolerances where the method chooses its step, and numbers of load steps where the deck seeks
equilibria. The automatic step of others is made longer and
shorter by its two bounds, the share of the critical step and the longest step. Meshes divide the
elements of all parts; descriptions are those of deformation that the types of parts know. A field
may be any whose values are compared, as different models of one thing.
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil
from types import ModuleType
from typing import NamedTuple, get_args

from crashsolve.deck.card import Card
from crashsolve.deck.family import CHOSEN
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.reading.deck import Deck
from crashsolve.deck.run_cards.control import Control
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.model.build import build
from crashsolve.recording.engines import is_static
from crashsolve.study import meshes as mesh_fields
from crashsolve.study.methods import chooses_its_step

# of the load steps of equilibria, and the name of their series
LOAD_FACTORS, EQUILIBRIA = (1, 2, 4), "newton"
FACTORS = (4.0, 2.0, 1.0, 1 / 2, 1 / 4, 1 / 8)
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
MESHES = "1,2,4"
METHODS = [
    name for name in get_args(Control.model_fields["integrator"].annotation) if name not in CHOSEN
]
# a run of a study is compared with others anyway
ALONE = {"control.estimate": "off", "control.accuracy": "null"}
AUTO = "auto"
# label, overrides, factor on the automatic step
Words = tuple[str, dict[str, str], float | None]


class Series(NamedTuple):
    """Common settings of the runs of one curve: method, elements times `mesh`, description."""

    method: str
    mesh: int = 1
    description: str = ""

    @property
    def name(self) -> str:
        """Name for tables and plots."""
        mesh = f"mesh x{self.mesh}" if self.mesh > 1 else ""
        return ", ".join(filter(None, (self.method, mesh, self.description)))


@dataclass(frozen=True)
class Setting:
    """One run of a study: a series, its step in words, and the changes of the deck.

    `factor` is that on the automatic step, where this is changed.
    """

    series: Series
    label: str
    overrides: dict[str, str]
    factor: float | None = None

    @property
    def name(self) -> str:
        """Name for tables and plots."""
        return f"{self.series.name} {self.label}"

    @property
    def folder(self) -> str:
        """Name of the folder of the run."""
        label = self.name.replace("/", "_over_").replace("*", "_times_")
        return label.replace(", ", "_").replace(" ", "_")


def settings(
    deck: Deck,
    methods: Sequence[str],
    steps: str | None,
    tolerances: str | None,
    meshes: str = "1",
    vary: str | None = None,
) -> list[Setting]:
    """All settings, of each series from the longest step on. Raises DeckError for a wrong word."""
    all_settings = []
    field, values = varied(deck, vary) if vary else ("", [""])
    for method, value in product(methods or [deck.control.integrator], values):
        for mesh, description in product(_meshes(deck, meshes), descriptions(deck) or [""]):
            # where there is no choice the deck has no word for it
            chosen = description if len(descriptions(deck)) > 1 else ""
            series = Series(method, mesh, ", ".join(filter(None, (chosen, value))))
            given = {} if method == EQUILIBRIA else {"control.integrator": method}
            given |= _of_parts(deck, mesh, chosen)
            given |= {field: value} if value else {}
            # numbers of a study are of other channels too
            given |= {"output.history.channels": "null"} if deck.output.history.channels else {}
            all_settings += [
                Setting(series, label, ALONE | given | overrides, factor)
                for label, overrides, factor in _of_method(deck, method, steps, tolerances)
            ]
    return all_settings


def varied(deck: Deck, text: str) -> tuple[str, list[str]]:
    """A field and its values, of PATH=A,B,... or of PATH alone for a choice of words.

    Raises DeckError.
    """
    path, _, listed = text.partition("=")
    values = [value.strip() for value in listed.split(",") if value.strip()]
    values = values or _words(deck, path.split("."))
    if not values:
        message = f"'{path}' is no choice of words whose values are known"
        advice = f"write --vary {path}=A,B,... with the values to compare"
        raise DeckError(f"--vary {text}", None, None, "", message, advice)
    return path, list(dict.fromkeys(values))


def _words(deck: Deck, path: list[str]) -> list[str]:
    """The words among which a field of a card, at a path of the deck, chooses."""
    if path[0] == "control":
        cards: list[Card] = [deck.control]
        names = path[1:]
    else:
        entries = [*deck.entries.get(path[0], {}).values(), *deck.written_out]
        known = [e for e in entries if [e.item.keyword, e.name] == path[:2] and not e.item.owner]
        cards, names = [entry.card for entry in known], path[2:]
    for card in cards:
        for name in names[:-1]:
            card = getattr(card, name, None)
        if isinstance(card, Card) and names and names[-1] in deck_words(type(card)):
            return list(declared(type(card), deck_words(type(card))[names[-1]]).words)
    return []


def _meshes(deck: Deck, text: str) -> list[int]:
    """Factors on the number of elements. Raises DeckError."""
    words = _numbers("--meshes", text)
    whole = [int(float(word)) for word in words]
    if list(map(float, words)) != list(map(float, whole)):
        message = "an element can be divided only into a whole number of them"
        raise DeckError(f"--meshes {text}", None, None, "", message, "write --meshes 1,2,4")
    if whole != [1] and not mesh_fields.divisible(deck):
        message = "the deck has no part whose elements can be divided"
        advice = "leave it out"
        if mesh_fields.undivided(deck):
            message += f"; {mesh_fields.undivided(deck)[0]} has a listed mesh, or that of a file"
        raise DeckError(f"--meshes {text}", None, None, "", message, advice)
    try:
        mesh_fields.finer(deck, max(whole))
    except ValueError as why:
        advice = "leave --meshes out, or name points that stay"
        raise DeckError(f"--meshes {text}", None, None, "", str(why), advice) from None
    return sorted(whole)


def descriptions(deck: Deck) -> list[str]:
    """The descriptions of deformation among which the parts of a deck can choose."""
    return list(dict.fromkeys(word for m in _part_modules(deck) for word in m.DESCRIPTIONS))


def order_of_mesh(deck: Deck, of_shells: float = mesh_fields.SHELLS_ORDER) -> float | None:
    """Order of the parts in the length of their elements, `of_shells` that of shells; None without
    parts.
    """
    orders = [float(getattr(module, "ORDER", of_shells)) for module in _modules(deck)]
    orders += [mesh_fields.SEGMENTS_ORDER] * mesh_fields.has_segments(deck)
    return min(orders, default=None)


def _modules(deck: Deck) -> list[ModuleType]:
    return [importlib.import_module(e.module_name) for e in deck.entries["parts"].values()]


def _part_modules(deck: Deck) -> list[ModuleType]:
    return [module for module in _modules(deck) if hasattr(module, "DESCRIPTIONS")]


def _of_parts(deck: Deck, mesh: int, description: str) -> dict[str, str]:
    """Overrides of the deck for a mesh and a description."""
    changes = mesh_fields.finer(deck, mesh)
    if description:
        own = [name for name, part in deck.entries["parts"].items() if not part.item.owner]
        changes |= {f"parts.{name}.description": description for name in own}
    return changes


def suited(deck: Deck) -> tuple[list[str], list[str]]:
    """All methods that can run a deck, its own first; and why the others cannot."""
    if is_static(deck):
        return [EQUILIBRIA], []
    own, suited_methods, notes = resolved(deck, deck.control.integrator), [], []
    for method in sorted(METHODS, key=lambda method: method != own):
        try:
            build(replace(deck, control=deck.control.model_copy(update={"integrator": method})))
        except DeckErrors as refusal:
            notes.append(f"{method} is left out: {refusal.errors[0].message}")
        else:
            suited_methods.append(method)
    return suited_methods, notes


def resolved(deck: Deck, method: str) -> str:
    """The method that auto or default stands for; any other as it is."""
    if is_static(deck):
        return EQUILIBRIA
    if method not in CHOSEN:
        return method
    return build(replace(deck, control=deck.control.model_copy(update={"integrator": method})))[
        0
    ].integrator


def _of_method(deck: Deck, method: str, steps: str | None, tolerances: str | None) -> list[Words]:
    """One method's settings."""
    if method == EQUILIBRIA:
        return [_load_steps(deck, factor) for factor in LOAD_FACTORS]
    step = deck.control.step
    # the step of a deck is that of its own method
    is_free = step == AUTO or method != deck.control.integrator
    if chooses_its_step(method) and (tolerances or (not steps and is_free)):
        words = _numbers("--tolerances", tolerances) if tolerances else TOLERANCES
        return [_within(t) for t in sorted(map(float, words), reverse=True)]
    if steps:
        given = _numbers("--steps", steps, AUTO)
        numbers = sorted((float(h) for h in given if h != AUTO), reverse=True)
        return [_automatic(deck, 1.0)] * (AUTO in given) + [_fixed(h) for h in numbers]
    if step == AUTO:
        return [_automatic(deck, factor) for factor in FACTORS]
    return [_fixed(float(step) * factor) for factor in FACTORS]


def _load_steps(deck: Deck, factor: int) -> Words:
    """The load steps of a deck of equilibria, each cut into `factor`."""
    control, interval = deck.control, deck.output.history.interval
    count = control.steps * factor
    overrides = {"control.steps": str(count)}
    if interval:
        count = ceil((control.end_time - control.start_time) / interval * factor)
        overrides = {"output.history.interval": f"{interval / factor!r} s"}
    return f"{count} load steps", overrides, 1.0 / factor


def _within(tolerance: float) -> Words:
    return (
        f"tolerance {tolerance:.12g}",
        {"control.tolerance": repr(tolerance), "control.step": AUTO},
        None,
    )


def _fixed(step: float) -> Words:
    # with its unit: bare numbers of the deck may be in another
    return f"{step:.12g}", {"control.step": f"{step!r} s"}, None


def _automatic(deck: Deck, factor: float) -> Words:
    """The automatic step with both bounds times a factor."""
    if factor == 1.0:
        return AUTO, {"control.step": AUTO}, factor
    control = deck.control
    span = control.end_time - control.start_time
    # a step never passes a sample
    longest = min(control.step_max or span, deck.sample_interval) or 1.0
    overrides = {
        "control.step": AUTO,
        "control.safety": repr(min(control.safety * factor, 1.0)),
        "control.step_max": f"{longest * factor!r} s",
    }
    label = f"auto*{factor:.12g}" if factor > 1.0 else f"auto/{1 / factor:.12g}"
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
