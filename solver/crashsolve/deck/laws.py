"""The folder tree as the registry of laws: the deck's `type: word` is the file `<folder>/word.py`.

Types are found by looking at files; only the modules a deck uses are imported.
"""

import importlib
import re
from difflib import get_close_matches
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
def types_in(folder: str) -> dict[str, Path]:
    """Type words of a family folder and their files, sorted; files without a card are left out."""
    root = package_folder() / folder
    return {
        path.stem: path
        for path in sorted(root.glob("[!_]*.py"))
        if re.search(rf"^class {class_name(path.stem)}\(", path.read_text("utf-8"), re.MULTILINE)
    }


def law_module(folder: str, word: object) -> ModuleType:
    """Module of a type, imported now; raises UnknownType."""
    types = types_in(folder)
    if not isinstance(word, str) or word not in types:
        near = get_close_matches(str(word), list(types), n=1, cutoff=SIMILARITY)
        advice = choices(word, types, "types")
        if isinstance(word, str) and word.isidentifier() and word[0] != "_":
            file = Path(folder) / f"{word}.py"
            # a name longer than the file system allows would raise an error
            if isfile(package_folder() / file):
                location = f"{PACKAGE}/{file.as_posix()}"
                advice = f"{location} has no `class {class_name(word)}(...)`, its card"
        raise UnknownType(f"unknown type '{shortened(str(word))}'", advice, "".join(near))
    return _checked(f"{PACKAGE}.{folder.replace('/', '.')}.{word}", types[word])


@cache
def _checked(name: str, path: Path) -> ModuleType:
    """The module of a law. Raises FamilyError for one that does not provide what it must."""
    module = imported(name, path)
    check_law(module)
    return module


def type_word(card: object) -> str:
    """Type word of a card of a family: the name of its file."""
    return type(card).__module__.rpartition(".")[2]
