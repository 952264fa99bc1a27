"""The folder tree as the registry of laws: the deck's `type: word` is the file `<folder>/word.py`.

Types are found by looking at files; only the modules a deck uses are imported.
"""

import importlib
import re
from collections.abc import Iterable
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crashsolve.deck.card import Card

PACKAGE = __name__.partition(".")[0]


class UnknownType(Exception):
    """A `type:` word without a file."""

    def __init__(self, message: str, advice: str) -> None:
        self.message = message
        self.advice = advice
        super().__init__(message, advice)


def class_name(word: str) -> str:
    """Name of the card in the file of this type: linear_spring -> LinearSpring."""
    return "".join(part.capitalize() for part in word.split("_"))


def package_folder() -> Path:
    """Root folder of the package that holds the families."""
    return Path(next(iter(importlib.import_module(PACKAGE).__path__)))


@cache
def types_in(folder: str) -> dict[str, Path]:
    """Type words of a family folder and their files, sorted; files without a card are left out."""
    root = package_folder() / folder
    return {
        path.stem: path
        for path in sorted(root.glob("[!_]*.py"))
        if re.search(rf"^class {class_name(path.stem)}\(", path.read_text("utf-8"), re.MULTILINE)
    }


def law_class(folder: str, word: object) -> "type[Card]":
    """Card class of a type, its module imported now; raises UnknownType."""
    types = types_in(folder)
    if not isinstance(word, str) or word not in types:
        raise UnknownType(f"unknown type '{word}'", choices(word, types, "types"))
    module = importlib.import_module(f"{PACKAGE}.{folder.replace('/', '.')}.{word}")
    card: type[Card] = getattr(module, class_name(word))
    return card


def type_word(card: "Card") -> str:
    """Type word of a card of a family: the name of its file."""
    return type(card).__module__.rpartition(".")[2]


def nearest(word: object, known: Iterable[str]) -> str:
    """Question about a wrong word: the right one most like it, if any is."""
    near = get_close_matches(str(word), list(known), n=1)
    return f"did you mean '{near[0]}'?" if near else ""


def choices(word: object, known: Iterable[str], what: str) -> str:
    """Advice on a wrong word: the right one most like it, and the list of all."""
    names = list(known)
    listed = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    return f"{nearest(word, names)} ({what}: {listed or 'none'})".lstrip()
