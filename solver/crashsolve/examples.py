"""Example decks and pages of the manual: beside the code when installed, else in the repository."""

import re
from os.path import commonpath, isfile
from pathlib import Path
from shutil import copyfile

from crashsolve.deck.card import Card
from crashsolve.deck.fields import deck_words
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.words import choices
from crashsolve.foundation.errors import DeckError
from crashsolve.output.files import reported

PLAN = ".plan.yaml"
PACKAGE = Path(__file__).resolve().parent
REPOSITORY = PACKAGE.parents[1]
# of a page its heading; of a deck its title, else its first comment
TITLES = {".md": (r"^# +(.+)$",), ".yaml": (r"^title: *(.+)$", r"^# (?!long$)(.+)$")}


def decks() -> dict[str, Path]:
    """Example decks by their names, such as tutorial/bouncing_ball."""
    return _listed_files("decks", REPOSITORY / "decks", ".yaml")


def pages() -> dict[str, Path]:
    """Pages of the manual by their names, such as theory/shells."""
    return _listed_files("manual", REPOSITORY / "solver", ".md")


def listing(known: dict[str, Path]) -> str:
    """Names and titles, a line each."""
    width = max(map(len, known), default=0)
    lines = []
    for name, path in known.items():
        text, patterns = path.read_text("utf-8"), TITLES[path.suffix]
        titles = (re.search(pattern, text, re.MULTILINE) for pattern in patterns)
        title = next((match[1].strip() for match in titles if match), "")
        lines.append(f"{name.ljust(width)}  {title}".rstrip())
    return "\n".join(lines)


def named(name: str, known: dict[str, Path], what: str) -> Path:
    """The file of a name, of which the last part is enough. Raises DeckError."""
    word = name.removesuffix(".yaml").removesuffix(".md")
    if word in known:
        return known[word]
    same = [long for long in known if long.rpartition("/")[2] == word]
    if len(same) == 1:
        return known[same[0]]
    message = f"is the name of {', '.join(same)}" if same else f"there is no {what} of this name"
    leaves = [long.rpartition("/")[2] for long in known]
    advice = "give it in full" if same else choices(word, [*known, *leaves], f"{what}s")
    raise DeckError(name, None, None, "", message, advice)


def needed(path: Path) -> list[Path]:
    """A deck, the files that it includes, and those of curves and meshes that they name.

    Of the plan of a sweep those of its deck as well.
    """
    if path.name.endswith(PLAN):
        from crashsolve.sweep.plan import read_plan

        return [path, *needed(Path(read_plan(path).card.deck))]
    deck = read_deck(path)
    return list(dict.fromkeys([*deck.files, *_named_files(deck)]))


def write(path: Path, folder: Path) -> list[Path]:
    """Copy a deck with the files that it includes; returns the files written.

    Raises: OutputError, DeckError.
    """
    files = needed(path)
    root = Path(commonpath([file.parent for file in files]))
    targets = [folder / file.relative_to(root) for file in files]
    for target in targets:
        if target.exists():
            raise DeckError(str(target), None, None, "", "exists", "write into another folder")
    for file, target in zip(files, targets, strict=True):
        with reported(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            copyfile(file, target)
    return targets


def _listed_files(installed: str, source: Path, suffix: str) -> dict[str, Path]:
    root = PACKAGE / installed if (PACKAGE / installed).is_dir() else source
    files = [path for path in sorted(root.rglob(f"*{suffix}")) if "shared" not in path.parts]
    return {str(path.relative_to(root).with_suffix("")): path for path in files}


def _named_files(deck: Deck) -> list[Path]:
    """Files that cards name: text that is the path of one."""
    cards = [entry.card for entries in deck.entries.values() for entry in entries.values()]
    return [Path(text) for card in cards for text in _texts(card) if isfile(text)]


def _texts(value: object) -> list[str]:
    """All words within a card."""
    if isinstance(value, str):
        return [value]
    if isinstance(value, tuple):
        return [text for part in value for text in _texts(part)]
    if not isinstance(value, Card):
        return []
    return [
        text for name in deck_words(type(value)).values() for text in _texts(getattr(value, name))
    ]
