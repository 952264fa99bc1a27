"""Errors of a deck that follow from another one: a mistake has one message.

Names that were to stand in a section which cannot be read are not judged. A name that many cards
use and none defines is one mistake: its first message counts the others.
"""

import re
from collections.abc import Collection, Mapping
from pathlib import Path

from crashsolve.deck.keywords import SECTIONS, answering
from crashsolve.deck.source import BROKEN, Table
from crashsolve.foundation.errors import DeckError

# parts define bodies and surfaces too
ALSO_DEFINED_BY = {"bodies": {"parts"}, "surfaces": {"parts"}}
# so many messages of one unknown name are shown each at its position
FEW = 3
# the kind of name, and the name
_UNKNOWN = re.compile(r"\b(unknown [a-z ]+) '.*?'$")


def without_consequences(
    errors: Collection[DeckError], tables: Mapping[Path, Table]
) -> list[DeckError]:
    """Errors in their order, without those that follow from others."""
    kinds = _kinds_of(_unreadable(tables))
    kept = [error for error in errors if _kind(error) not in kinds]
    groups: dict[str, list[DeckError]] = {}
    for error in kept:
        groups.setdefault(_mistake(error), []).append(error)
    shown = []
    for error in kept:
        group = groups[_mistake(error)]
        if len(group) <= FEW or not _kind(error):
            shown.append(error)
        elif error is group[0]:
            at = (error.file, error.line, error.column)
            message = f"{error.message} (and {len(group) - 1} more)"
            shown.append(DeckError(*at, error.card, message, error.advice))
    return shown


def _unreadable(tables: Mapping[Path, Table]) -> set[str]:
    """Sections that are no tables of names."""
    return {
        keyword
        for table in tables.values()
        for keyword, value in table.items()
        if value is BROKEN or not isinstance(value, Table | None)
    }


def _kinds_of(sections: set[str]) -> set[str]:
    """Kinds of names that these sections would define: "unknown body"."""
    named = {"parameters": "parameter"} | {word: SECTIONS[word].singular for word in SECTIONS}
    return {
        f"unknown {singular}"
        for word, singular in named.items()
        if sections & {*answering(word), *ALSO_DEFINED_BY.get(word, ())}
    }


def _kind(error: DeckError) -> str:
    """The kind of name that an error does not know; empty: another error."""
    match = _UNKNOWN.search(error.message)
    return match[1] if match else ""


def _mistake(error: DeckError) -> str:
    """The same for errors of one mistake: a name, or all names of a kind where none are given."""
    match = _UNKNOWN.search(error.message)
    if not match:
        return str(error)
    return match[1] if error.advice.endswith(": none)") else match[0]
