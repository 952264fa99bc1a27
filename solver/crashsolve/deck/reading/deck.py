"""Reading a deck: files to items, items to cards, cards to a Deck; or all errors at once."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from crashsolve.channels.units import SI
from crashsolve.deck.card import Card, Name, Reference, law_class, reference_of
from crashsolve.deck.diagnostics import Diagnostic, diagnostics_of, shown
from crashsolve.deck.dump import as_data, as_text
from crashsolve.deck.expansion import MADE, expand, represents_many
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.keywords import SECTIONS, answering
from crashsolve.deck.laws import UnknownType, types_in
from crashsolve.deck.numbers import Context
from crashsolve.deck.reading.consequences import without_consequences
from crashsolve.deck.reading.files import Files
from crashsolve.deck.reading.items import Entry, Item, items_of
from crashsolve.deck.reading.locations import placed
from crashsolve.deck.reading.overrides import set_fields
from crashsolve.deck.reading.parameters import Parameters
from crashsolve.deck.reading.parts import joints_of_parts, part_nodes
from crashsolve.deck.reading.size import excess
from crashsolve.deck.reading.surface_groups import SurfaceGroups
from crashsolve.deck.reading.unused import Unused, ineffective, unread, unused
from crashsolve.deck.run_cards.control import Control, cores_given
from crashsolve.deck.run_cards.expect import Expect
from crashsolve.deck.run_cards.output import Output
from crashsolve.deck.run_cards.units import Units
from crashsolve.deck.run_cards.watch import Watch
from crashsolve.deck.source import BROKEN, Position, Table
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError, DeckErrors

AnyCard = TypeVar("AnyCard", bound=Card)
# of control.threads; contacts are checked in model/build.py
UNSHARED = Diagnostic(
    ("threads",),
    "share the elements of shells, and rigid contacts with many elements (1000 on both sides "
    "together), and there are neither",
    "leave it out",
)
# units of x and y of a curve
Axes = tuple[str, str]


@dataclass(frozen=True)
class Deck:
    """A deck without errors: every number in SI, every name known."""

    title: str
    path: Path
    files: list[Path]
    # when each was last written [ns]
    written: list[int]
    parameters: dict[str, float]
    derived: list[str]  # names of those that follow from others
    with_units: dict[str, str]  # of parameters, their text
    control: Control
    output: Output
    expect: list[Expect]
    expect_at: list[Position]
    watch: list[Watch]
    watch_at: list[Position]
    entries: dict[str, dict[str, Entry]]
    control_item: Item
    # cards of the deck that were expanded, and are no entries any more
    written_out: list[Entry]
    # values set from outside that change nothing, and warnings of parameters unread
    ineffective: dict[str, DeckError]
    unread: list[str]
    # all values set from outside, by their paths
    given: dict[str, str]

    @cached_property
    def text(self) -> str:
        """The deck as one YAML text in SI, with includes, parameters and defaults written out."""
        return as_text(self)

    @property
    def sample_interval(self) -> float:
        """Time between samples [s]: as given, or a 1000th of the run, or a load step."""
        control = self.control
        count = control.steps if control.solution == "quasi_static" else 1000
        return self.output.history.interval or (control.end_time - control.start_time) / count

    @cached_property
    def threads(self) -> int:
        """Threads that share the steps: those of the deck, else those given to the job.

        Raises DeckErrors where the job was given no number.
        """
        if self.control.threads is not None:
            return self.control.threads
        # for pairs of bodies alone threads are faster from thousands of spheres on
        if not self.control.is_explicit or not _has_blocks(self.entries):
            return 1
        return cores_given()

    def unshared(self) -> DeckError:
        """The error for control.threads where there is nothing to share."""
        return placed(self.control_item, UNSHARED)

    def expectations(self) -> list[dict[str, object]]:
        """The expect cards as plain data with their lines, as the results keep them."""
        pairs = zip(self.expect, self.expect_at, strict=True)
        return [as_data(card) | {"line": location.line} for card, location in pairs]

    def error(self, entry: Entry, field: str | None, message: str, advice: str = "") -> DeckError:
        """An error found after reading, at a field such as "normal.stiffness" or "points.3"."""
        steps = field.split(".") if field else ()
        path = tuple(int(step) if step.isdecimal() else step for step in steps)
        return placed(entry.item, Diagnostic(path, message, advice))


def read_deck(
    path: Path | str, overrides: Mapping[str, str] | None = None, refuses_ineffective: bool = True
) -> Deck:
    """The deck in a file; `overrides` replace parameters, and fields such as `control.step`.

    Raises DeckErrors with all errors, overrides that change nothing among them if it
    `refuses_ineffective`: a value may be without effect in one of many runs.
    """
    deck = _Reader(Path(path), overrides or {}).deck()
    if deck.ineffective and refuses_ineffective:
        raise DeckErrors(list(deck.ineffective.values()))
    return deck


class _Reader:
    """Collects the errors of a deck while its cards are read."""

    def __init__(self, path: Path, overrides: Mapping[str, str]) -> None:
        self.path = path
        self.diagnostics: list[DeckError] = []
        self.nodes: list[str] = []
        self.axes: dict[str, Axes | None] = {}
        self.unread_parts: set[str] = set()
        self.written_out: list[Entry] = []
        # those that could not be written out in ordinary cards
        self.unwritten: set[str] = set()
        # names in cards that have other errors
        self.unread: list[tuple[Item, list[tuple[tuple[str | int, ...], Name]]]] = []
        files = Files(self.diagnostics)
        self.tables = files.read(path)
        self.paths = files.paths
        if files.incomplete:
            raise DeckErrors(self.in_order())
        self.items = items_of(self.tables, self.diagnostics)
        self.overrides = overrides
        self.unused: list[Unused] = []
        # keywords and names that cards name
        self.named: set[tuple[str, str]] = set()
        others = set_fields(self.items, overrides, self.tables, self.diagnostics)
        units = {table.file: table.get("units") for table in self.tables.values()}
        self.parameters = Parameters(self.items["parameters"], others, self.diagnostics, units)
        self.contexts = {file: self.context(file, table) for file, table in self.tables.items()}

    def check_all_names(self, entries: dict[str, dict[str, Entry]]) -> None:
        """Refuse names in cards that no entry has. Writes: diagnostics."""
        for group in entries.values():
            for entry in group.values():
                self.check_names(entry.item, _names(entry.card))
        for item, names in self.unread:
            self.check_names(item, names)

    def check_control(
        self, control: Control, entries: dict[str, dict[str, Entry]], has_questions: bool
    ) -> None:
        """Refuse an accuracy without channels, and threads without work. Writes: diagnostics."""
        item = self.items["control"][""]
        if control.accuracy and not has_questions:
            advice = "name channels under watch or expect"
            self.refuse(
                item, Diagnostic(("accuracy",), "needs channels whose error counts", advice)
            )
        may_share = bool(entries["contacts"]) or _has_blocks(entries)
        if (control.threads or 1) > 1 and not self.unread_parts and not may_share:
            self.refuse(item, UNSHARED)

    def deck(self) -> Deck:
        """The whole deck; raises DeckErrors."""
        self.expand()
        # the card that uses a curve determines the units of its numbers
        others = {keyword: self.section(keyword) for keyword in SECTIONS if keyword != "curves"}
        self.axes = self.axes_of_curves(others)
        read = others | {"curves": self.section("curves")}
        entries = {keyword: read[keyword] for keyword in SECTIONS}
        control, output = self.single("control", Control), self.single("output", Output)
        expect = [self.card(item, Expect) for item in self.items["expect"].values()]
        watch = [self.card(item, Watch) for item in self.items["watch"].values()]
        title = self.title()
        self.refuse_endless(entries)
        self.unread_parts = set(self.items["parts"]) - set(entries["parts"]) | self.unwritten
        self.nodes = part_nodes(entries["parts"], self.items["bodies"], self.diagnostics)
        entries["joints"] |= joints_of_parts(entries, self.diagnostics)
        self.check_all_names(entries)
        if control:
            self.check_control(control, entries, has_questions=bool(watch or expect))
        if self.diagnostics or not control or not output:
            raise DeckErrors(self.in_order())
        self.unused += unused(self.items, control.unused(bool(output.history.interval)), self.named)
        return Deck(
            title=title,
            path=self.path,
            files=self.paths,
            written=[path.stat().st_mtime_ns for path in self.paths],
            parameters={name: float(v) for name, v in self.parameters.values.items()},
            derived=self.parameters.derived,
            with_units=self.parameters.with_units,
            control=control,
            output=output,
            expect=[card for card in expect if card],
            expect_at=[item.where for item in self.items["expect"].values()],
            watch=[card for card in watch if card],
            watch_at=[item.where for item in self.items["watch"].values()],
            entries=entries,
            control_item=self.items["control"][""],
            written_out=self.written_out,
            ineffective=ineffective(self.items, self.parameters, self.unused, self.overrides),
            unread=unread(self.parameters, self.unused, next(iter(self.tables))),
            given=dict(self.overrides),
        )

    def expand(self) -> None:
        """Expand cards that represent many. Writes: items, contexts."""
        self.contexts[MADE] = Context()
        several = [item for item in self.items["parts"].values() if represents_many(item)]
        laws = {word: self.section(word) for word in ("sections", "materials") if several}
        control = self.substituted(self.items["control"][""]) if self.items["control"] else None
        for item in several:
            entry = self.entry(item)
            if entry is None:
                continue
            names = list(_names(entry.card))
            self.check_names(item, names)
            # curves are requested by the cards that are made
            is_known = all(name in laws[name.keyword] for _, name in names if name.keyword in laws)
            self.written_out.append(entry)
            paths = import_module(entry.module_name).unused(entry.card)
            self.unused += [Unused(item, path, why) for path, why in paths.items()]
            if not is_known or not expand(entry, laws, control, self.items, self.refuse):
                self.unwritten.add(item.name)
            del self.items["parts"][item.name]
        valid = [entry for entry in self.written_out if entry.name not in self.unwritten]
        groups = SurfaceGroups(valid, laws, control, self.items, self.refuse)
        for contact in self.items["contacts"].values() if valid else ():
            groups.substitute(contact)

    def refuse_endless(self, entries: dict[str, dict[str, Entry]]) -> None:
        """Raise DeckErrors at a part with which the model is too large: its names have no room."""
        shells = beams = 0
        shared = [(entry, entry.card) for entry in entries["meshes"].values()]
        others = [(part, getattr(part.card, "mesh", None)) for part in entries["parts"].values()]
        for part, mesh in shared + others:
            own = getattr(part.card, "beams", 0)
            more = 0 if own else getattr(mesh, "count", 0)
            why = excess(shells + more, beams + own)
            if why:
                within = ("mesh",) if hasattr(mesh, "elements") and mesh is not part.card else ()
                path = (*within, "elements")
                self.refuse(part.item, Diagnostic(path, why, "take fewer"))
                raise DeckErrors(self.in_order())
            shells, beams = shells + more, beams + own

    def in_order(self) -> list[DeckError]:
        """Each error once, by file and line; those of the command line first."""
        order = {str(file): i for i, file in enumerate(self.tables)}
        unique = {str(error): error for error in self.diagnostics}.values()
        ordered = sorted(unique, key=lambda e: (order.get(e.file, -1), e.line or 0, e.column or 0))
        return without_consequences(ordered, self.tables)

    def context(self, file: Path, table: Table) -> Context:
        """Folder of a file, and the units of its bare numbers."""
        if "units" not in table:
            return Context(folder=file.parent)
        where = table.key_location("units")
        item = Item("units", "", table["units"], where, table.value_location("units"), file)
        units = self.card(item, Units)
        if units is None:
            return Context(folder=file.parent)
        return Context(units.bases(), file.parent, units.symbols())

    def title(self) -> str:
        item = self.items["title"].get("")
        value = self.substituted(item) if item else self.path.stem
        if item and not isinstance(value, str) and value is not BROKEN:
            message = f"must be text, not {shown(value)}"
            self.diagnostics.append(DeckError(*item.at, "title", message, "put it in quotes"))
        if item and "\n" in str(value):
            self.diagnostics.append(DeckError(*item.at, "title", "must be one line"))
        return str(value)

    def single(self, keyword: str, kind: type[AnyCard]) -> AnyCard | None:
        """The one card of a keyword, with its defaults when absent."""
        start = Position(str(self.path), 1, 1)
        absent = Item(keyword, "", Table(str(self.path)), start, start, self.path)
        return self.card(self.items[keyword].get("", absent), kind)

    def section(self, keyword: str) -> dict[str, Entry]:
        """The entries of a keyword; those with errors are left out."""
        entries = (self.entry(item) for item in self.items[keyword].values())
        return {entry.name: entry for entry in entries if entry}

    def entry(self, item: Item) -> Entry | None:
        value = {} if item.value is None else item.value
        if not isinstance(value, Mapping):
            if value is not BROKEN:
                self.refuse(item, Diagnostic((), f"must be a table of fields, not {shown(value)}"))
            return None
        section = SECTIONS[item.keyword]
        word = value.get("type", section.default)
        if not word and "type" not in value:
            types = ", ".join(types_in(section.folder))
            self.refuse(item, Diagnostic((), "missing field 'type'", f"(types: {types})", key=True))
            self.substituted(item)
            return None
        try:
            kind = law_class(section.folder, word)
        except UnknownType as error:
            if word is not BROKEN:
                self.refuse(item, Diagnostic(("type",), error.message, error.advice))
            if error.near:
                # further errors, if this type is meant
                kind = law_class(section.folder, error.near)
                meant = self.card(item, kind, "type", is_certain=False)
                self.unread += [(item, list(_names(meant)))] * (meant is not None)
            else:
                self.substituted(item)
            return None
        card = self.card(item, kind, "type")
        if card is None:
            return None
        return Entry(item.name, word, kind.__module__, card, item.where, item)

    def card(
        self, item: Item, kind: type[AnyCard], without: str = "", is_certain: bool = True
    ) -> AnyCard | None:
        """The card of an item; None after reporting its errors.

        Of a card whose kind is not certain, nothing is missed.
        """
        value = self.substituted(item)
        if value is BROKEN:
            return None
        if isinstance(value, Mapping):
            value = {word: part for word, part in value.items() if word != without}
        context = self.contexts[item.file] if item.keyword != "units" else Context()
        if item.keyword == "curves":
            context = context._replace(axes=self.axes.get(item.name))
            if self.diagnostics and item.name not in self.axes:
                # its user may be among the wrong cards; these are refused anyway
                context = context._replace(units=SI)
        try:
            return kind.model_validate(value, context=context)
        except ValidationError as error:
            for diagnostic in diagnostics_of(kind, error):
                if is_certain or not diagnostic.is_missing:
                    self.refuse(item, diagnostic)
            self.unread.append((item, list(_names_written(kind, value))))
        assert self.diagnostics, f"{item.title} was refused without a reason"
        return None

    def axes_of_curves(self, entries: Mapping[str, dict[str, Entry]]) -> dict[str, Axes | None]:
        """Units of x and y of every curve that is used; None where its uses differ in them."""
        axes_of: dict[str, set[tuple[str, str]]] = {}
        for group in entries.values():
            for entry in group.values():
                for name, axes in _curves_of(entry.card):
                    axes_of.setdefault(name, set()).add(axes)
        return {name: some.pop() if len(some) == 1 else None for name, some in axes_of.items()}

    def substituted(self, item: Item) -> object:
        """The value of an item with its expressions worked out; a missing one is an empty table."""
        value = Table(str(item.file)) if item.value is None else item.value
        return self.parameters.substitute(value, item.title, item.at)

    def refuse(self, item: Item, diagnostic: Diagnostic) -> None:
        self.diagnostics.append(placed(item, diagnostic))

    def check_names(self, item: Item, names: Iterable[tuple[tuple[str | int, ...], Name]]) -> None:
        """Report names in a card that no entry of the deck has."""
        for path, name in names:
            self.named.add((name.keyword, str(name)))
            if self.may_be_made(name):
                continue
            known = [own for keyword in answering(name.keyword) for own in self.items[keyword]]
            if name.keyword == "bodies":
                known += self.nodes
            if name not in known:
                message = f"unknown {SECTIONS[name.keyword].singular} '{name}'"
                self.refuse(item, Diagnostic(path, message, choices(name, known, name.keyword)))

    def may_be_made(self, name: Name) -> bool:
        """Whether it is the ground, or what a part that could not be read may be made of."""
        if name.keyword != "bodies":
            return name.keyword == "surfaces" and name in self.unread_parts
        return name == "ground" or any(name.startswith(f"{part}_") for part in self.unread_parts)


def _curves_of(value: object) -> Iterator[tuple[str, tuple[str, str]]]:
    """Curves that a card and those within it name, with the units of their axes."""
    if isinstance(value, tuple) and value and isinstance(value[0], Card):
        for part in value:
            yield from _curves_of(part)
    if isinstance(value, Card):
        for name, axes in value.curve_axes.items():
            if getattr(value, name) is not None:
                yield str(getattr(value, name)), axes
        for name in type(value).model_fields:
            yield from _curves_of(getattr(value, name))


def _names_written(kind: type[Card], value: object) -> Iterator[tuple[tuple[str | int, ...], Name]]:
    """References in the fields of a card as they are written, each with its path."""
    if not isinstance(value, Mapping):
        return
    for word, name in deck_words(kind).items():
        keyword = reference_of(kind.model_fields[name])
        given = value.get(word)
        several = given if isinstance(given, list) else [given]
        for i, text in enumerate(several):
            if keyword and isinstance(text, str):
                yield (word, i) if isinstance(given, list) else (word,), Reference(keyword)(text)


def _has_blocks(entries: dict[str, dict[str, Entry]]) -> bool:
    """Whether there are parts that keep their elements in blocks."""
    parts = (import_module(e.module_name) for e in entries["parts"].values())
    return any(hasattr(part, "KINDS") for part in parts)


def _names(
    value: object, path: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], Name]]:
    """References to entries within a card, each with its path."""
    if isinstance(value, Name):
        yield path, value
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            yield from _names(part, (*path, i))
    elif isinstance(value, Card):
        for word, name in deck_words(type(value)).items():
            if not declared(type(value), name).unit:
                yield from _names(getattr(value, name), (*path, word))
