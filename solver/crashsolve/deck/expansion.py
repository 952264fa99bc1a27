"""Cards that stand for many: they are written out in ordinary ones before names are looked up.

The module of such a type has `expand(name, card, laws, control)`: a pure function from the card,
the sections and materials of the deck and the words of its control to other cards. Positions
and errors of these are those of the card that they are made of; their numbers are in SI. It may
have `surfaces(name, card, laws, control, faces_balls)`: those that its name means in a contact.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from crashsolve.deck.card import law_class
from crashsolve.deck.diagnostics import Diagnostic
from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.laws import types_in
from crashsolve.deck.reading.items import Entry, Item, Items
from crashsolve.deck.source import locate

# stands for the file of cards that are made: they have no units of their own
MADE = Path("<made>")
Steps = tuple[str | int, ...]
# words of a card, as decks have them
Fields = dict[str, Any]


class Law(NamedTuple):
    """A section or material of the deck: its name, type, module and card."""

    name: str
    type: str
    module: ModuleType
    card: Any


class Made(NamedTuple):
    """A card that an expansion has made, and the path in the expanded card from which it is
    made.
    """

    keyword: str
    name: str
    fields: Fields
    path: Steps = ()


class Problem(ValueError):
    """An error at a path of a card that cannot be written out."""

    def __init__(self, path: Steps, message: str, advice: str = "") -> None:
        super().__init__(message)
        self.path, self.message, self.advice = path, message, advice


def represents_many(item: Item) -> bool:
    """Whether the type of an item is one whose cards are written out."""
    word = item.value.get("type") if isinstance(item.value, Mapping) else None
    folder = SECTIONS[item.keyword].folder
    if not isinstance(word, str) or word not in types_in(folder):
        return False
    return hasattr(import_module(law_class(folder, word).__module__), "expand")


def expand(
    entry: Entry,
    laws: Mapping[str, Mapping[str, Entry]],
    control: object,
    items: Items,
    refuse: Callable[[Item, Diagnostic], None],
) -> bool:
    """Write an entry out in cards of its own; returns whether all went well.

    `laws` are the entries of sections and materials. Errors go to `refuse`. Writes: items.
    """
    words = control if isinstance(control, Mapping) else {}
    law = import_module(entry.module_name)
    try:
        # numbers beyond all measure are refused where these cards are built
        with np.errstate(all="ignore"):
            cards = law.expand(entry.name, entry.card, known(laws), words)
    except Problem as problem:
        refuse(entry.item, Diagnostic(problem.path, problem.message, problem.advice))
        return False
    return add(entry, cards, items, refuse)


def known(laws: Mapping[str, Mapping[str, Entry]]) -> dict[str, dict[str, Law]]:
    """Entries of sections and materials as those who write cards out see them."""
    return {
        keyword: {
            name: Law(name, law.type, import_module(law.module_name), law.card)
            for name, law in entries.items()
        }
        for keyword, entries in laws.items()
    }


def add(
    entry: Entry, cards: list[Made], items: Items, refuse: Callable[[Item, Diagnostic], None]
) -> bool:
    """Add cards that an entry is written out in; returns whether none has a name of another.

    Writes: items.
    """
    is_well, owner = True, entry.item.title
    for card in cards:
        where = locate(entry.where, entry.item.value, card.path, False)
        item = Item(card.keyword, card.name, card.fields, where, where, MADE, owner=owner)
        if card.name in items[card.keyword]:
            message = f"its {item.what} has a name that is already in use"
            refuse(entry.item, Diagnostic(card.path, message, "rename one of them"))
            is_well = False
        else:
            items[card.keyword][card.name] = item
    return is_well
