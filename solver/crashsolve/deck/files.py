"""The files of a deck: the one named by the user and those it includes."""

from os.path import isfile
from pathlib import Path

from crashsolve.deck.source import BROKEN, Position, Rows, Table, read_yaml
from crashsolve.foundation.errors import DeckError

# files within files
DEEPEST = 50


class Files:
    """Reads a deck and its includes; what is wrong with any of them goes to `mistakes`.

    `incomplete` tells that a file is missing, so that names not found may stand in it.
    """

    def __init__(self, mistakes: list[DeckError]) -> None:
        self.mistakes = mistakes
        self.tables: dict[Path, Table] = {}
        self.seen: set[Path] = set()
        self.open: list[Path] = []
        self.incomplete = False

    def read(self, path: Path) -> dict[Path, Table]:
        """All files, each before those it includes."""
        table = read_yaml(path, self.mistakes)
        if table is None:
            self.incomplete = True
            return self.tables
        self.tables[path] = table
        self.seen.add(path.resolve())
        self.open.append(path.resolve())
        for name, place in self._included(table):
            problem = self._problem(path.parent / name)
            if problem:
                self.mistakes.append(DeckError(*place, "include", problem))
                self.incomplete = True
            else:
                self.read(path.parent / name)
        self.open.pop()
        return self.tables

    def _problem(self, path: Path) -> str:
        """Why a file cannot be included, if so."""
        if not isfile(path):
            return f"there is no file '{path}'"
        if len(self.open) >= DEEPEST:
            return f"includes are nested more than {DEEPEST} deep"
        if path.resolve() in self.open:
            chain = [*self.open[self.open.index(path.resolve()) :], path]
            return f"the file includes itself ({' -> '.join(link.name for link in chain)})"
        return "the file is included twice" if path.resolve() in self.seen else ""

    def _included(self, table: Table) -> list[tuple[str, Position]]:
        names = table.get("include")
        if isinstance(names, Rows):
            found = [(name, names.place(i)) for i, name in enumerate(names)]
        elif names is None or names is BROKEN:
            return []
        else:
            found = [(names, table.value_place("include"))]
        for name, place in found:
            if not isinstance(name, str) and name is not BROKEN:
                message = "must be the name of a file, or a list of names"
                self.mistakes.append(DeckError(*place, "include", message))
        return [(name, place) for name, place in found if isinstance(name, str)]
