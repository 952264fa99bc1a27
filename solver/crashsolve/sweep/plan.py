"""The plan of a sweep: a YAML file beside the deck, whose errors are reported before anything runs.

deck: bouncing_ball.yaml
design: {type: sobol, runs: 64}
vary:
  height: {from: "0.3 m", to: "1 m"}
  contacts.bounce.normal.restitution: [0.5, 0.7, 0.9]
measure:
  - {name: peak, channel: rcforc.bounce.force.normal, statistic: max, unit: kN}
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

from pydantic import ValidationError, field_validator, model_validator

from crashsolve.channels.display import Product
from crashsolve.channels.errors import ChannelError
from crashsolve.channels.expression import channels_in
from crashsolve.channels.series import Window
from crashsolve.channels.units import UnitError
from crashsolve.deck.card import Card, FileName, quantity, word
from crashsolve.deck.diagnostics import Diagnostic, diagnostics_of, refuse, shown
from crashsolve.deck.numbers import Context
from crashsolve.deck.reading.overrides import PARAMETERS
from crashsolve.deck.run_cards.statistic import check_window, known_statistic, words_reported
from crashsolve.deck.source import BROKEN, Position, Table, locate, read_yaml
from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.output.files import Json
from crashsolve.sweep.axis import Axis

DRAWN = ("latin_hypercube", "sobol", "saltelli")
LISTED = ("grid", "list")
MAX_RUNS = 100_000
# of every table
COLUMNS = ("run", "state", "message")


class Design(Card):
    """Choice of the values that are run together, or the bare word of its type."""

    shorthand: ClassVar[str] = "type"

    type: Literal["grid", "list", "latin_hypercube", "sobol", "saltelli"] = word(
        "grid: every value with every other; list: first values together, then second ones, ...; "
        "latin_hypercube, sobol: drawn from the ranges; saltelli: `runs` times (parameters + 2) "
        "runs, from which crashpost finds Sobol indices"
    )
    runs: int | None = word("number of runs, a power of two for sobol and saltelli", None)
    seed: int = word("of the random numbers: the same seed draws the same values", 1, ge=0)

    @model_validator(mode="after")
    def _has_runs(self) -> "Design":
        if self.type in LISTED:
            if self.runs is not None or "seed" in self.model_fields_set:
                name = "runs" if self.runs is not None else "seed"
                raise ValueError(f"{name}: of a {self.type}, the values alone say what is run")
            return self
        if self.runs is None:
            raise ValueError(f"runs: {self.type} needs their number")
        if not 1 <= self.runs <= MAX_RUNS:
            raise ValueError(f"runs: must be from 1 to {MAX_RUNS}, not {self.runs}")
        if self.type != "latin_hypercube" and self.runs & (self.runs - 1):
            below = 1 << (self.runs.bit_length() - 1)
            message = f"{self.runs} points of a Sobol sequence are not balanced"
            raise ValueError(f"runs: {message}; take a power of two, {below} or {2 * below}")
        return self


class Measure(Card):
    """A number asked of every run: a statistic of a channel, as under expect."""

    name: str = word("heading of its column; channel and statistic when empty", "")
    channel: str = word("channel, or arithmetic of channels")
    statistic: str = word(words_reported())
    during: Window | None = quantity("s", "[from, to], when only these samples count", None)
    unit: str | None = word("unit of the number; the channel's own when absent", None)

    @field_validator("statistic")
    @classmethod
    def _known_statistic(cls, text: str) -> str:
        return known_statistic(text)

    @field_validator("channel")
    @classmethod
    def _readable(cls, text: str) -> str:
        try:
            # names of channels may have a "-", and none has brackets
            if "(" in text:
                channels_in(text)
        except ChannelError as error:
            refuse(str(error))
        return text

    @field_validator("unit")
    @classmethod
    def _known_unit(cls, text: str | None) -> str | None:
        try:
            Product.parse(text or "")
        except UnitError as error:
            refuse(str(error))
        return text

    @model_validator(mode="after")
    def _has_window(self) -> "Measure":
        check_window(self.statistic, self.during)
        return self

    @property
    def title(self) -> str:
        """Name of its column."""
        return self.name or f"{self.channel} {self.statistic}"


class PlanCard(Card):
    """A sweep: the deck, the varied parameters, and the measures of every run."""

    title: str = word("heading of table and pictures; that of the deck when empty", "")
    deck: FileName = word("deck to run, beside the plan")
    design: Design = word("combination of the values")
    vary: Json = word("parameters or paths of the deck, each with values or a range")
    set: Json = word("values of the deck that are the same in all runs", {})
    measure: tuple[Measure, ...] = word("measures of every run")
    time_limit: float | None = quantity("s", "wall time after which a run is stopped", None, gt=0)

    @field_validator("vary", "measure")
    @classmethod
    def _some(cls, value: object) -> object:
        if not value:
            refuse("is empty")
        return value

    @field_validator("set")
    @classmethod
    def _plain(cls, values: Json) -> Json:
        for name, value in values.items():
            if not isinstance(value, str | int | float | bool | None):
                refuse(f"must be a number or a word, not {shown(value)}", within=(name,))
        return values


@dataclass(frozen=True)
class Plan:
    """A plan without errors. `locations` states where varied and set names stand, for messages."""

    path: Path
    card: PlanCard
    axes: dict[str, Axis]
    locations: dict[str, Position]

    @property
    def deck(self) -> Path:
        """The deck, by its full path: results are the same wherever they are made from."""
        return Path(self.card.deck).resolve()


def read_plan(path: Path) -> Plan:
    """The plan in a file. Raises DeckErrors with all its errors."""
    errors: list[DeckError] = []
    table = read_yaml(path, errors)
    if table is None:
        raise DeckErrors(errors)
    context, card = Context(folder=path.parent), None
    diagnostics: list[Diagnostic] = []
    try:
        card = PlanCard.model_validate(table, context=context)
    except ValidationError as error:
        diagnostics += diagnostics_of(PlanCard, error)
    axes = _axes(table.get("vary"), context, diagnostics)
    if card is not None and len(axes) == len(card.vary):
        diagnostics += _contradictions(card, axes)
    if diagnostics or errors or card is None:
        raise DeckErrors(_in_order([*errors, *(_placed(path, table, m) for m in diagnostics)]))
    locations = {
        name: locate(_start(path), table, (keyword, name), True)
        for keyword, names in (("set", card.set), ("vary", axes))
        for name in names
    }
    return Plan(path, card, axes, locations)


def _axes(given: object, context: Context, diagnostics: list[Diagnostic]) -> dict[str, Axis]:
    """The varied parameters; their errors go to `diagnostics`."""
    axes = {}
    for name, value in given.items() if isinstance(given, Mapping) else ():
        if value is BROKEN:
            continue
        fields = {"values": value} if isinstance(value, list) else value
        if not isinstance(fields, Mapping):
            message = f"must be a list of values or a range, not {shown(value)}"
            diagnostics.append(
                Diagnostic(("vary", name), message, "write [1, 2] or {from: 1, to: 2}")
            )
            continue
        try:
            axes[name] = Axis.model_validate(fields, context=context)
        except ValidationError as error:
            for diagnostic in diagnostics_of(Axis, error):
                # a bare list has no word `values`
                within = diagnostic.path[1:] if isinstance(value, list) else diagnostic.path
                diagnostics.append(diagnostic._replace(path=("vary", name, *within)))
    return axes


def _contradictions(card: PlanCard, axes: Mapping[str, Axis]) -> list[Diagnostic]:
    """Contradictions between the fields of a plan."""
    diagnostics, known = [], dict[str, str]()
    for keyword, name in (*(("vary", n) for n in axes), *(("set", n) for n in card.set)):
        own = name.removeprefix(PARAMETERS)
        if own in known:
            message = f"'{name}' is given already, under {known[own]}"
            diagnostics.append(Diagnostic((keyword, name), message, "leave one of them out", True))
        known[own] = keyword
    titles = {*axes, *COLUMNS}
    for name in axes:
        if name in COLUMNS:
            message = f"'{name}' is a column of the table already"
            diagnostics.append(
                Diagnostic(("vary", name), message, f"write parameters.{name}", True)
            )
    for i, measure in enumerate(card.measure):
        if measure.title in titles:
            message = f"'{measure.title}' is a heading already"
            diagnostics.append(Diagnostic(("measure", i), message, "give it another name"))
        titles.add(measure.title)
    kind = card.design.type
    for name, axis in axes.items():
        diagnostics += [m._replace(path=("vary", name, *m.path)) for m in _unfit(kind, axis)]
    lengths = {name: len(axis.values) for name, axis in axes.items() if axis.values is not None}
    if kind == "list" and len(set(lengths.values())) > 1:
        message = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        diagnostics.append(
            Diagnostic(("vary",), f"the lists must be of one length: {message} values", "")
        )
    return diagnostics


def _unfit(kind: str, axis: Axis) -> list[Diagnostic]:
    """Reason why the values of a parameter do not fit the design."""
    diagnostics = []
    if kind == "list" and axis.values is None:
        diagnostics.append(
            Diagnostic((), "a range does not go with design: list", "write its values")
        )
    if kind == "grid" and axis.values is None and axis.count is None:
        diagnostics.append(Diagnostic((), "the range needs a number of values", "write count: 5"))
    if kind == "grid" and axis.distribution not in ("uniform", "log_uniform"):
        message = f"{axis.distribution} values are random, and a grid has none"
        diagnostics.append(
            Diagnostic(("distribution",), message, "take design: {type: sobol, runs: 64}")
        )
    if kind in DRAWN and axis.count is not None:
        diagnostics.append(
            Diagnostic(("count",), f"belongs to a grid, and the design is {kind}", "")
        )
    if kind in ("grid", *DRAWN) and axis.values is not None:
        texts = axis.texts()
        twice = next((text for text in texts if texts.count(text) > 1), None)
        if twice is not None:
            diagnostics.append(
                Diagnostic((), f"has the value {twice} twice", "leave one of them out")
            )
    return diagnostics


def _start(path: Path) -> Position:
    return Position(str(path), 1, 1)


def _placed(path: Path, table: Table, diagnostic: Diagnostic) -> DeckError:
    """An error with its location in the file."""
    below = diagnostic.path[:-1] if diagnostic.key else diagnostic.path
    words = [str(step + 1) if isinstance(step, int) else step for step in below]
    location = locate(_start(path), table, diagnostic.path, diagnostic.key)
    return DeckError(*location, " ".join(words), diagnostic.message, diagnostic.advice)


def _in_order(errors: list[DeckError]) -> list[DeckError]:
    return sorted(errors, key=lambda error: (error.line or 0, error.column or 0))
