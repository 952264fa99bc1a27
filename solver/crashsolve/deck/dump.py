"""A deck written out again: SI numbers, includes merged, parameters and defaults filled in."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, Protocol

from crashsolve.deck.card import Card
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.laws import type_word
from crashsolve.deck.source import plain_scalar


class Written(Protocol):
    """An entry: its card."""

    @property
    def card(self) -> Card: ...


class Dumped(Protocol):
    """The entries from which a deck is written."""

    @property
    def title(self) -> str: ...
    @property
    def parameters(self) -> Mapping[str, float]: ...
    @property
    def control(self) -> Card: ...
    @property
    def output(self) -> Card: ...
    @property
    def entries(self) -> Mapping[str, Mapping[str, Written]]: ...
    @property
    def watch(self) -> Sequence[Card]: ...
    @property
    def expect(self) -> Sequence[Card]: ...


def as_data(value: object) -> Any:
    """A card as plain tables, lists and values, as a deck would hold it."""
    if isinstance(value, tuple):
        return [as_data(part) for part in value]
    if isinstance(value, str):
        return str(value)
    if not isinstance(value, Card):
        return value
    data: dict[str, object] = {}
    for word, name in deck_words(type(value)).items():
        part, field = getattr(value, name), declared(type(value), name)
        if part is not None or field.info.default is not None:
            data[word] = as_law(part) if field.law and part else as_data(part)
    return data


def as_law(card: Card) -> dict[str, object]:
    """A card of a family as plain data, its type first."""
    return {"type": type_word(card), **as_data(card)}


def as_text(deck: Dumped) -> str:
    """The deck as one YAML text that reads back as the same deck."""
    data: dict[str, object] = {"title": deck.title, "parameters": deck.parameters}
    data["control"] = as_data(deck.control)
    for keyword, entries in deck.entries.items():
        data[keyword] = {name: as_law(entry.card) for name, entry in entries.items()}
    data["output"] = as_data(deck.output)
    data["watch"] = [as_data(card) for card in deck.watch]
    data["expect"] = [as_data(card) for card in deck.expect]
    return "\n".join(_lines({word: value for word, value in data.items() if value})) + "\n"


_PLAIN = re.compile(r"[^\W\d][\w.-]*( [\w.-]+)*")


def _lines(data: Mapping[str, object], indent: str = "") -> Iterator[str]:
    """Lines of a table: tables within tables, rows of lists; all else on the line of its key."""
    for word, value in data.items():
        head = f"{indent}{_flow(word)}:"
        if isinstance(value, dict) and len(indent) < 4:
            yield head if value else f"{head} {{}}"
            yield from _lines(value, indent + "  ")
        elif isinstance(value, list) and value and not isinstance(value[0], str | float | int):
            yield head
            yield from (f"{indent}  - {_flow(part)}" for part in value)
        else:
            yield f"{head} {_flow(value)}"


def _flow(value: object) -> str:
    """A value on one line; text in quotes where YAML could take it for anything else."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_flow, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_flow(word)}: {_flow(part)}' for word, part in value.items())}}}"
    return repr(value) if isinstance(value, float) else json.dumps(value)


# names and fields come again and again
@cache
def _text(text: str) -> str:
    is_plain = _PLAIN.fullmatch(text) and plain_scalar(text)[0] == text
    return text if is_plain else _quoted(text)


# line ends and unprintable characters of YAML which JSON would leave as they are
_TO_ESCAPE = re.compile(r"[\x7f-\xa0\u2028\u2029\ufeff\ufffe\uffff]")


def _quoted(text: str) -> str:
    quoted = json.dumps(text, ensure_ascii=False)
    return _TO_ESCAPE.sub(lambda match: f"\\u{ord(match[0]):04x}", quoted)
