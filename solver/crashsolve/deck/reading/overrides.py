"""Values set from outside the deck: `control.step=1e-4`, `contacts.wall.normal.stiffness=1e6`.

A path leads from a keyword over the name of an entry to a field; entries of lists count from 1:
`bodies.ball.velocity.3`, `expect.1.value`. A name without a dot is a parameter, else a keyword. So
one deck can be run with many steps, methods, laws and meshes. Bare numbers are in the units of the
file that holds the card. What is wrong with a value is reported at its location on the command
line.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from crashsolve.deck.diagnostics import shown
from crashsolve.deck.keywords import KEYWORDS, LISTS, SECTIONS
from crashsolve.deck.reading.items import Item, Items, Step
from crashsolve.deck.source import Position, Rows, Table, plain_scalar
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError

PARAMETERS = "parameters."


class _NoSuchLocation(Exception):
    """A path that leads nowhere, with advice."""

    def __init__(self, message: str, advice: str = "", card: str = "") -> None:
        self.message, self.advice, self.card = message, advice, card
        super().__init__(message)


def set_fields(
    items: Items,
    overrides: Mapping[str, str],
    tables: dict[Path, Table],
    diagnostics: list[DeckError],
) -> dict[str, str]:
    """Write values into their items; returns those of parameters.

    Errors of a path go to `errors`. Writes: items, tables.
    """
    parameters: dict[str, str] = {}
    for name, text in overrides.items():
        own = name.removeprefix(PARAMETERS)
        if own in items["parameters"] or ("." not in own and own not in KEYWORDS):
            if own in parameters:
                problem = f"parameter '{own}' is set twice, to {shown(parameters[own])} and this"
                location = f"--set {name}={text}"
                diagnostics.append(
                    DeckError(location, None, None, "", problem, "leave one of them out")
                )
            parameters[own] = text
            continue
        value, message, advice = plain_scalar(text.strip())
        try:
            if message:
                raise _NoSuchLocation(message, advice)
            if text.strip()[:1] in ("[", "{") and name != "title":
                advice = f"write it in the deck, and set its entries, as {name}.1=VALUE"
                raise _NoSuchLocation("a list or a table cannot be set", advice)
            _set(items, tables, name, f"--set {name}={text}", value)
        except _NoSuchLocation as no:
            location = f"--set {name}={text}"
            diagnostics.append(DeckError(location, None, None, no.card, no.message, no.advice))
    return parameters


def _set(items: Items, tables: dict[Path, Table], name: str, given: str, value: object) -> None:
    """Write one value where its path leads. Raises _NoSuchPlace."""
    keyword, *path = name.split(".")
    main = next(iter(tables))
    if keyword not in KEYWORDS:
        raise _NoSuchLocation(
            f"unknown keyword '{keyword}'", choices(keyword, KEYWORDS, "keywords")
        )
    if keyword == "include":
        raise _NoSuchLocation("files are read before anything is set", "write it in the deck")
    if keyword == "units":
        # they belong to the deck's own file
        tables[main] = _put(tables[main], [keyword, *path], value, (1, 1))
        return
    start = Position(str(main), 1, 1)
    entry = path.pop(0) if path and keyword in SECTIONS | LISTS.keys() else ""
    _check_entry(keyword, entry, path, items)
    item = items[keyword].get(entry) or Item(keyword, entry, None, start, start, main)
    old = Table(str(item.file)) if item.value is None and path else item.value
    new = _put(old, path, value, (item.where.line, item.where.column))
    steps = tuple(int(step) - 1 if _is_location(step) else step for step in path)
    items[keyword][entry] = item._replace(value=new, given={**item.given, steps: given})


def _check_entry(keyword: str, entry: str, path: list[str], items: Items) -> None:
    """Refuse a path without an entry or a field where there must be one."""
    if keyword in SECTIONS | LISTS.keys():
        singular = SECTIONS[keyword].singular if keyword in SECTIONS else keyword
        if not entry:
            message = f"which {singular}, and which field of it?"
            raise _NoSuchLocation(message, f"write {keyword}.NAME.FIELD=VALUE", keyword)
        if entry not in items[keyword]:
            advice = choices(entry, items[keyword], keyword)
            raise _NoSuchLocation(f"unknown {singular} '{entry}'", advice, keyword)
        if not path:
            advice = f"write {keyword}.{entry}.FIELD=VALUE"
            raise _NoSuchLocation(f"which field of the {singular}?", advice, keyword)
    elif keyword != "title" and not path:
        raise _NoSuchLocation("which field of it?", f"write {keyword}.FIELD=VALUE", keyword)
    elif keyword == "title" and path:
        raise _NoSuchLocation("has no fields", "write title=TEXT", keyword)


def _put(old: object, path: list[str], value: object, at: tuple[int, int]) -> Any:
    """A copy of a value with another at a path; missing tables of the path are created."""
    if not path:
        return value
    word, rest = path[0], path[1:]
    if isinstance(old, Table):
        inner = old.get(word)
        if inner is None and rest:
            if _is_location(rest[0]):
                raise _NoSuchLocation(f"the deck has no list '{word}' here", "write it in the deck")
            inner = Table(old.file)
        return _copied(old, lambda table: table.put(word, _put(inner, rest, value, at), at, at))
    if isinstance(old, Rows):
        if not _is_location(word) or not 1 <= int(word) <= len(old):
            message = f"'{word}' is no position of a list of {len(old)}"
            raise _NoSuchLocation(message, f"entries count from 1 to {len(old)}")
        rows = Rows(old.file)
        rows.extend(old)
        rows.values_at = list(old.values_at)
        rows[int(word) - 1] = _put(old[int(word) - 1], rest, value, at)
        return rows
    raise _NoSuchLocation(f"there is no field '{word}' here: the deck has {shown(old)}")


def _is_location(word: str) -> bool:
    """Whether a word of a path counts in a list."""
    return word.isdecimal() and len(word) < 10


def _copied(old: Table, change: Callable[[Table], None]) -> Table:
    """A copy of a table after a change: others may be anchored to the table itself."""
    table = Table(old.file)
    for key, value in old.items():
        table.put(key, value, old.keys_at[key], old.values_at[key])
    change(table)
    return table


def location_given(item: Item, path: tuple[Step, ...], is_key: bool) -> str:
    """The option of the command line that has set the value at a path, or "" if none has."""
    for own, given in item.given.items():
        if path[: len(own)] == own or (is_key and own[: len(path)] == path):
            return given
    return ""
