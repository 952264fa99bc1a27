"""The files of a deck: the one named by the user and those it includes.

A file may be included several times, each time with other words in it: of

    include: [{file: car.yaml, with: {car: car_1, mass: 68 t}}, {file: car.yaml, with: ...}]

every `<car>` in the names and texts of car.yaml stands for car_1, then for the next word. Words
are put in before anything is worked out, so that they may stand in names and in expressions.
"""

import re
from collections.abc import Callable
from os.path import isfile
from pathlib import Path
from typing import Any, NamedTuple

from crashsolve.deck.diagnostics import shown
from crashsolve.deck.source import BROKEN, Position, Rows, Table, plain_scalar, read_yaml
from crashsolve.foundation.errors import DeckError

# files within files, files in all, and letters of a text once its words are put in
DEEPEST, MAX_FILES, LONGEST = 50, 5_000, 10_000
_WORD = re.compile(r"<([A-Za-z_][A-Za-z0-9_]*)>")


class Included(NamedTuple):
    """A file to include, the words put into it, and where the deck asks for it."""

    name: str
    words: dict[str, str]
    location: Position


class Files:
    """Reads a deck and its includes; their errors are added to `errors`.

    `incomplete` states that a file is missing, so that names not found may stand in it. A file that
    is included again has a path of its own in `tables`, in the same folder; `paths` are real ones.
    """

    def __init__(self, diagnostics: list[DeckError]) -> None:
        self.diagnostics = diagnostics
        self.tables: dict[Path, Table] = {}
        self.paths: list[Path] = []
        self.seen: set[tuple[Path, tuple[tuple[str, str], ...]]] = set()
        self.open: dict[Path, None] = {}
        # of files that are included many times: each is read, and its path resolved, once
        self._contents: dict[Path, Table | None] = {}
        self._real: dict[Path, Path] = {}
        self._times: dict[Path, int] = {}
        self._is_full = False
        self.incomplete = False

    def read(self, path: Path, words: dict[str, str] | None = None) -> dict[Path, Table]:
        """All files, each before those it includes."""
        if path not in self._contents:
            self._contents[path] = read_yaml(path, self.diagnostics)
        table = self._contents[path]
        if table is None:
            self.incomplete = True
            return self.tables
        if words is not None:
            table = self._filled_in(table, words, path)
        self.tables[self._own_path(path)] = table
        if self._times[path] == 1:
            self.paths.append(path)
        self.seen.add(self._key(path, words or {}))
        self.open[self._resolved(path)] = None
        for file in self._included(table):
            if self._is_full:
                break
            problem = self._problem(path.parent / file.name, file.words)
            if problem:
                self.diagnostics.append(DeckError(*file.location, "include", problem))
                self.incomplete = True
            else:
                self.read(path.parent / file.name, file.words or None)
        self.open.popitem()
        return self.tables

    def _own_path(self, path: Path) -> Path:
        """The path, or one like it where the file has been included before."""
        count = self._times[path] = self._times.get(path, 0) + 1
        own = path if count == 1 else path.with_name(f"{path.name} ({count})")
        # a file of its own may have such a name
        while own in self.tables:
            count += 1
            own = path.with_name(f"{path.name} ({count})")
        return own

    def _resolved(self, path: Path) -> Path:
        """The real path of a file."""
        if path not in self._real:
            self._real[path] = path.resolve()
        return self._real[path]

    def _key(self, path: Path, words: dict[str, str]) -> tuple[Path, tuple[tuple[str, str], ...]]:
        """Key by which two includes are the same."""
        return self._resolved(path), tuple(sorted(words.items()))

    def _problem(self, path: Path, words: dict[str, str]) -> str:
        """The reason why a file cannot be included, if any."""
        if path not in self._contents and not isfile(path):
            return f"there is no file '{path}'"
        if len(self.open) >= DEEPEST:
            return f"includes are nested more than {DEEPEST} deep"
        if len(self.tables) >= MAX_FILES:
            self._is_full = True
            return (
                f"the deck has more than {MAX_FILES} files, each counted as often as it is included"
            )
        if self._resolved(path) in self.open:
            files = list(self.open)
            chain = [*files[files.index(self._resolved(path)) :], path]
            return f"the file includes itself ({' -> '.join(link.name for link in chain)})"
        with_same = " with the same words" if words else ""
        return (
            f"the file is included twice{with_same}" if self._key(path, words) in self.seen else ""
        )

    def _included(self, table: Table) -> list[Included]:
        """Files that a file includes; an error for each entry that cannot be read."""
        names = table.get("include")
        if isinstance(names, Rows):
            included = [(name, names.location(i)) for i, name in enumerate(names)]
        elif names is None or names is BROKEN:
            return []
        else:
            included = [(names, table.value_location("include"))]
        files = []
        for name, location in included:
            file = name.get("file") if isinstance(name, Table) else name
            if isinstance(file, str):
                words = self._words(name, location) if isinstance(name, Table) else {}
                files.append(Included(file, words, location))
            elif name is not BROKEN and file is not BROKEN:
                message = "must be the name of a file, or a list of names"
                advice = "or write {file: NAME, with: {WORD: TEXT}}" * isinstance(name, Table)
                self.diagnostics.append(DeckError(*location, "include", message, advice))
        return files

    def _words(self, entry: Table, location: Position) -> dict[str, str]:
        """The words that an entry of include puts into its file, each as it is written."""
        for key in entry.keys() - {"file", "with"}:
            message = f"unknown field '{key}'"
            self.diagnostics.append(
                DeckError(*entry.key_location(key), "include", message, "(fields: file, with)")
            )
        given = entry.get("with", {})
        if not isinstance(given, Table):
            if "with" in entry and given is not BROKEN:
                message = f"with: must be a table of words, not {shown(given)}"
                self.diagnostics.append(DeckError(*location, "include", message))
            return {}
        words = {}
        for word, value in given.items():
            is_plain = isinstance(value, str | int | float) and not isinstance(value, bool)
            if not _WORD.fullmatch(f"<{word}>"):
                message, advice = f"with: '{word}' is no word", "letters, digits and _"
                self.diagnostics.append(
                    DeckError(*given.key_location(word), "include", message, advice)
                )
            elif is_plain:
                words[word] = str(value)
            elif value is not BROKEN:
                message = f"with: {word} must be text or a number, not {shown(value)}"
                self.diagnostics.append(DeckError(*given.value_location(word), "include", message))
        return words

    def _filled_in(self, table: Table, words: dict[str, str], path: Path) -> Table:
        """A copy of a file's table with its words put in; an error for each that is idle."""
        filling = _Filling(words, self.diagnostics)
        filled: Table = filling.value(table, lambda _: Position(str(path), 1, 1), 0)
        for word in words.keys() - filling.used:
            message = f"nothing in the file has the word <{word}>"
            self.diagnostics.append(DeckError(str(path), None, None, "include", message))
        # names would be wrong as well
        self.incomplete |= filling.used != words.keys()
        return filled


Located = Callable[[Any], Position]


class _Filling:
    """Puts words into the names and texts of a file."""

    def __init__(self, words: dict[str, str], diagnostics: list[DeckError]) -> None:
        self.words, self.diagnostics = words, diagnostics
        self.used: set[str] = set()

    def value(self, value: object, location: Located, key: Any) -> Any:
        """A value with the words put in; a lone word that is a number becomes one.

        `location` gives its place by its key or index.
        """
        if isinstance(value, Table):
            table = Table(value.file)
            for key, part in value.items():
                new = self.value(part, value.value_location, key)
                name = self.text(key, value.key_location, key)
                if name in table:
                    message = f"'{name}' is given twice with these words"
                    self.diagnostics.append(DeckError(*value.key_location(key), "include", message))
                table.put(name, new, value.keys_at[key], value.values_at[key])
            return table
        if isinstance(value, Rows):
            rows = Rows(value.file)
            rows.values_at = value.values_at
            rows.extend(self.value(part, value.location, i) for i, part in enumerate(value))
            return rows
        if not isinstance(value, str) or "<" not in value:
            return value
        text = self.text(value, location, key)
        plain, problem, _ = plain_scalar(text)
        return plain if _WORD.fullmatch(value.strip()) and not problem else text

    def text(self, text: str, location: Located, key: Any) -> str:
        """A text with the words put in; an error for each that is not given."""
        if "<" not in text:
            return text
        for word in _WORD.findall(text):
            if word not in self.words:
                advice = f"give it: with: {{{word}: ...}}"
                self.diagnostics.append(
                    DeckError(*location(key), "include", f"the word <{word}> is not given", advice)
                )
            self.used.add(word)
        filled = _WORD.sub(lambda match: self.words.get(match[1], match[0]), text)
        if len(filled) <= LONGEST or filled == text:
            return filled
        message = f"with its words put in the text has {len(filled)} letters, more than {LONGEST}"
        self.diagnostics.append(DeckError(*location(key), "include", message))
        return text
