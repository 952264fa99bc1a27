"""Items that the files of a deck define under keywords, each with its positions."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from crashsolve.deck.diagnostics import shown
from crashsolve.deck.keywords import KEYWORDS, LISTS, SECTIONS
from crashsolve.deck.source import BROKEN, NAME, NAME_ADVICE, Position, Rows, Table
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError

_NAMED = {keyword: section.singular for keyword, section in SECTIONS.items()}
_NAMED["parameters"] = "parameter"


# a word of a table, or a position in a list
Step = str | int


class Item(NamedTuple):
    """Something defined under a keyword: `where` is the position of its name, `at` of its value.

    `given` states by which words of the command line values within it were set, by their paths;
    `owner` is the title of the card that it is made of, if it does not stand in the deck.
    """

    keyword: str
    name: str
    value: Any
    where: Position
    at: Position
    file: Path
    given: Mapping[tuple[Step, ...], str] = MappingProxyType({})
    owner: str = ""

    @property
    def title(self) -> str:
        """The item as messages call it: spring 'buffer_left'."""
        return f"{self.owner}: its {self.what}" if self.owner else self.what

    @property
    def what(self) -> str:
        """The item without that which owns it: spring 'buffer_left'."""
        if self.keyword in LISTS:
            return f"{self.keyword} {self.name}"
        return f"{_NAMED[self.keyword]} '{self.name}'" if self.name else self.keyword


# by keyword and name
Items = dict[str, dict[str, Item]]


def items_of(tables: Mapping[Path, Table], diagnostics: list[DeckError]) -> Items:
    """All items of all files; their errors are added to `errors`."""
    items: Items = {keyword: {} for keyword in KEYWORDS}
    for file, table in tables.items():
        for item in _of_file(file, table, diagnostics):
            group = items[item.keyword]
            if item.keyword in LISTS:
                item = item._replace(name=str(len(group) + 1))
            first = group.setdefault(item.name, item)
            if first is not item:
                advice = f"first in {first.where.file}:{first.where.line}"
                diagnostics.append(DeckError(*item.where, item.title, "is given twice", advice))
    return items


def _of_file(file: Path, table: Table, diagnostics: list[DeckError]) -> Iterator[Item]:
    for keyword, value in table.items():
        where, at = table.key_location(keyword), table.value_location(keyword)
        if keyword not in KEYWORDS:
            advice = choices(keyword, KEYWORDS, "keywords")
            diagnostics.append(DeckError(*where, "", f"unknown keyword '{keyword}'", advice))
        elif keyword in _NAMED:
            yield from _named(file, keyword, value, at, diagnostics)
        elif keyword in LISTS:
            yield from _listed(file, keyword, value, at, diagnostics)
        elif keyword not in ("include", "units"):
            # includes are followed by now, and units belong to their file alone
            yield Item(keyword, "", value, where, at, file)


def _named(
    file: Path, keyword: str, value: object, at: Position, diagnostics: list[DeckError]
) -> Iterator[Item]:
    if not isinstance(value, Table):
        if value is not BROKEN and value is not None:
            message = f"must be a table of names, not {shown(value)}"
            diagnostics.append(DeckError(*at, keyword, message))
        return
    for name, part in value.items():
        item = Item(keyword, name, part, value.key_location(name), value.value_location(name), file)
        if not NAME.fullmatch(name):
            message = "is not a valid name"
            diagnostics.append(DeckError(*item.where, item.title, message, NAME_ADVICE))
        elif (keyword, name) == ("bodies", "ground"):
            message = "the ground is always there and cannot be defined"
            diagnostics.append(DeckError(*item.where, item.title, message))
        yield item


def _listed(
    file: Path, keyword: str, value: object, at: Position, diagnostics: list[DeckError]
) -> Iterator[Item]:
    if not isinstance(value, Rows):
        if value is not BROKEN and value is not None:
            diagnostics.append(DeckError(*at, keyword, f"must be a list, not {shown(value)}"))
        return
    for i, part in enumerate(value):
        yield Item(keyword, "", part, value.location(i), value.location(i), file)


class Entry(NamedTuple):
    """A named card of the deck, the module of its law, and where it stands."""

    name: str
    type: str
    module_name: str
    card: Any
    where: Position
    item: Item

    @property
    def is_made(self) -> bool:
        """Whether it does not stand in the deck, but is made of another card."""
        return bool(self.item.owner)
