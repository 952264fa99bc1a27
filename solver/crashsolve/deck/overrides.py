"""Fields of `control` set from outside the deck: `control.step=1e-4`.

So that one deck can be run with many steps and methods. Bare numbers are in the units of the file
that holds the card.
"""

from collections.abc import Mapping
from pathlib import Path

from crashsolve.deck.control import Control
from crashsolve.deck.fields import deck_words
from crashsolve.deck.items import Item, Items
from crashsolve.deck.laws import choices
from crashsolve.deck.source import Position, Table, plain_scalar
from crashsolve.foundation.errors import DeckError

PREFIX = "control."


def set_control(
    items: Items, overrides: Mapping[str, str], path: Path, mistakes: list[DeckError]
) -> dict[str, str]:
    """Write the fields of control into its item; returns the other overrides, of parameters.

    What is wrong with a field goes to `mistakes`.
    """
    fields = {name: text for name, text in overrides.items() if name.startswith(PREFIX)}
    if fields:
        item = items["control"].get("") or _empty(path)
        items["control"][""] = item._replace(value=_changed(item, fields, mistakes))
    return {name: text for name, text in overrides.items() if name not in fields}


def _empty(path: Path) -> Item:
    start = Position(str(path), 1, 1)
    return Item("control", "", None, start, start, path)


def _changed(item: Item, fields: Mapping[str, str], mistakes: list[DeckError]) -> object:
    """A copy of the card with the fields set; what is no table is left for its own message."""
    old = Table(str(item.file)) if item.value is None else item.value
    if not isinstance(old, Table):
        return old
    table, at = Table(old.file), (item.where.line, item.where.column)
    for key, value in old.items():
        table.put(key, value, old.keys_at[key], old.values_at[key])
    known = deck_words(Control)
    for name, text in fields.items():
        word = name.removeprefix(PREFIX)
        value, message, advice = plain_scalar(text.strip())
        if word not in known:
            message, advice = f"unknown field '{word}'", choices(word, known, "fields")
        if message:
            place = f"--set {name}={text}"
            mistakes.append(DeckError(place, None, None, "control", message, advice))
        else:
            table.put(word, value, at, at)
    return table
