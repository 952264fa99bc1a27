"""A deck written out again: SI numbers, includes merged, parameters and defaults filled in."""

from typing import TYPE_CHECKING, Any

import yaml

from crashsolve.deck.card import Card
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.laws import type_word
from crashsolve.deck.source import plain_scalar

if TYPE_CHECKING:
    from crashsolve.deck.read import Deck


def as_data(value: Any) -> Any:
    """A card as plain tables, lists and values, as a deck would hold it."""
    if isinstance(value, tuple):
        return [as_data(part) for part in value]
    if isinstance(value, str):
        return str(value)
    if not isinstance(value, Card):
        return value
    data: dict[str, Any] = {}
    for word, name in deck_words(type(value)).items():
        part, field = getattr(value, name), declared(type(value), name)
        if part is not None or field.info.default is not None:
            data[word] = as_law(part) if field.law and part else as_data(part)
    return data


def as_law(card: Card) -> dict[str, Any]:
    """A card of a family as plain data, its type first."""
    return {"type": type_word(card), **as_data(card)}


def as_text(deck: "Deck") -> str:
    """The deck as one YAML text that reads back as the same deck."""
    data: dict[str, Any] = {"title": deck.title, "parameters": deck.parameters}
    data["control"] = as_data(deck.control)
    for keyword, entries in deck.entries.items():
        data[keyword] = {name: as_law(entry.card) for name, entry in entries.items()}
    data["output"] = as_data(deck.output)
    data["expect"] = [as_data(card) for card in deck.expect]
    filled = {keyword: value for keyword, value in data.items() if value}
    layout: Any = {"sort_keys": False, "allow_unicode": True, "default_flow_style": None}
    return str(yaml.dump(filled, Dumper=_Dumper, width=100, **layout))


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Puts into quotes what YAML 1.2 would take for a number."""


def _text(dumper: Any, text: str) -> Any:
    style = None if plain_scalar(text)[0] == text else "'"
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _text)
