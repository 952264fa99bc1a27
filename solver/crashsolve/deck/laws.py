"""The folder tree as the registry of laws: the deck's `type: word` is the file `<folder>/word.py`.

Types are found by looking at files; only the modules a deck uses are imported.
"""

import importlib
from functools import cache
from os.path import isfile
from pathlib import Path
from types import ModuleType

from crashsolve.deck.family import check_law, imported
from crashsolve.deck.words import choices, shortened

# how much a wrong word must be like a type to be a misspelling of it, 1 for the same
SIMILARITY = 0.75
PACKAGE = __name__.partition(".")[0]


class UnknownType(Exception):
    """A `type:` word without a file; `near` is the type it misspells, or ""."""

    def __init__(self, message: str, advice: str, near: str = "") -> None:
        self.message = message
        self.advice = advice
        self.near = near
        super().__init__(message, advice)


def class_name(word: str) -> str:
    """Name of the card in the file of this type: linear_spring -> LinearSpring."""
    return "".join(part.capitalize() for part in word.split("_"))


def package_folder() -> Path:
    """Root folder of the package that holds the families."""
    return Path(next(iter(importlib.import_module(PACKAGE).__path__)))


@cache
def card_file(folder: str, word: str) -> Path | None:
    """The file of a type; None where there is none, or it has no card."""
    path = package_folder() / folder / f"{word}.py"
    if not word.isidentifier() or word[0] == "_" or not isfile(path):
        return None
    is_card = f"\nclass {class_name(word)}(" in path.read_text("utf-8")
    return path if is_card else None


@cache
def types_in(folder: str) -> dict[str, Path]:
    """Type words of a family folder and their files, sorted; files without a card are left out."""
    root = package_folder() / folder
    words = sorted(path.stem for path in root.glob("[!_]*.py"))
    return {word: path for word in words if (path := card_file(folder, word))}


def law_module(folder: str, word: object) -> ModuleType:
    """Module of a type, imported now; raises UnknownType."""
    path = card_file(folder, word) if isinstance(word, str) else None
    if not isinstance(word, str) or path is None:
        types = types_in(folder)
        from difflib import get_close_matches

        near = get_close_matches(str(word), list(types), n=1, cutoff=SIMILARITY)
        advice = choices(word, types, "types")
        if isinstance(word, str) and word.isidentifier() and word[0] != "_":
            file = Path(folder) / f"{word}.py"
            # a name longer than the file system allows would raise an error
            if isfile(package_folder() / file):
                location = f"{PACKAGE}/{file.as_posix()}"
                advice = f"{location} has no `class {class_name(word)}(...)`, its card"
        raise UnknownType(f"unknown type '{shortened(str(word))}'", advice, "".join(near))
    return _checked(f"{PACKAGE}.{folder.replace('/', '.')}.{word}", path)


@cache
def _checked(name: str, path: Path) -> ModuleType:
    """The module of a law. Raises FamilyError for one that does not provide what it must."""
    module = imported(name, path)
    check_law(module)
    return module


def type_word(card: object) -> str:
    """Type word of a card of a family: the name of its file."""
    return type(card).__module__.rpartition(".")[2]
