"""Fields set from outside the deck: `control.step=1e-4`, `parts.tube.mesh.division=2`.

So that one deck can be run with many steps, methods and meshes. Bare numbers are in the units of
the file that holds the card.
"""

from collections.abc import Mapping
from pathlib import Path

from crashsolve.deck.control import Control
from crashsolve.deck.fields import deck_words
from crashsolve.deck.items import Item, Items
from crashsolve.deck.laws import choices
from crashsolve.deck.source import Position, Table, plain_scalar
from crashsolve.foundation.errors import DeckError

CONTROL, PARTS = "control.", "parts."


def set_fields(
    items: Items, overrides: Mapping[str, str], path: Path, mistakes: list[DeckError]
) -> dict[str, str]:
    """Write the fields of control and of parts into their items; returns the other overrides.

    What is wrong with a field goes to `mistakes`.
    """
    fields = {name: text for name, text in overrides.items() if name.startswith(CONTROL)}
    if fields:
        item = items["control"].get("") or _empty(path)
        items["control"][""] = item._replace(value=_changed(item, fields, mistakes))
    of_parts = {name: text for name, text in overrides.items() if name.startswith(PARTS)}
    for name, text in of_parts.items():
        _set_part(items["parts"], name, text, mistakes)
    return {k: text for k, text in overrides.items() if k not in fields and k not in of_parts}


def _set_part(parts: dict[str, Item], name: str, text: str, mistakes: list[DeckError]) -> None:
    """Write one field of one part; its card says whether there is such a field. Writes: parts."""
    _, part, *path = name.split(".")
    value, message, advice = plain_scalar(text.strip())
    if part not in parts or not path:
        message = f"unknown part '{part}'" if path else "which field of the part?"
        advice = choices(part, parts, "parts") if path else f"write {name}.FIELD=VALUE"
    if message:
        mistakes.append(DeckError(f"--set {name}={text}", None, None, "parts", message, advice))
    else:
        item = parts[part]
        at = (item.where.line, item.where.column)
        parts[part] = item._replace(value=_put(item.value, path, value, at))


def _put(old: object, path: list[str], value: object, at: tuple[int, int]) -> object:
    """A copy of a table with one value at a path; what is no table is left for its own message."""
    if not path or not isinstance(old, Table):
        return old if path else value
    table, word = _copy(old), path[0]
    table.put(word, _put(old.get(word), path[1:], value, at), at, at)
    return table


def _copy(old: Table) -> Table:
    table = Table(old.file)
    for key, value in old.items():
        table.put(key, value, old.keys_at[key], old.values_at[key])
    return table


def _empty(path: Path) -> Item:
    start = Position(str(path), 1, 1)
    return Item("control", "", None, start, start, path)


def _changed(item: Item, fields: Mapping[str, str], mistakes: list[DeckError]) -> object:
    """A copy of the card with the fields set; what is no table is left for its own message."""
    old = Table(str(item.file)) if item.value is None else item.value
    if not isinstance(old, Table):
        return old
    table, at = _copy(old), (item.where.line, item.where.column)
    known = deck_words(Control)
    for name, text in fields.items():
        word = name.removeprefix(CONTROL)
        value, message, advice = plain_scalar(text.strip())
        if word not in known:
            message, advice = f"unknown field '{word}'", choices(word, known, "fields")
        if message:
            place = f"--set {name}={text}"
            mistakes.append(DeckError(place, None, None, "control", message, advice))
        else:
            table.put(word, value, at, at)
    return table
