"""A results folder, opened for reading: histories by channel name, status, log and deck.

`Result("trains.results").series("rcforc.left.force.normal")` is all a script needs. Rows whose
time is not a number are reserved by the writer and do not exist yet (FILE_FORMAT.md), so that a
result can be read while its run goes on.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.expression import Series, evaluate
from crashpost.status import read_status

FORMAT = "crashsolve history"
# the first one has other names for some energies, and reads the same
FORMAT_VERSIONS = (1, 2)


@dataclass(frozen=True)
class Column:
    """One quantity of every entity of a family."""

    path: str
    unit: str
    meaning: str

    @property
    def name(self) -> str:
        """The last words of the channel name: quantity.component."""
        return self.path.replace("/", ".")


@dataclass(frozen=True)
class Family:
    """A group of the history: entities sampled in the same columns."""

    name: str
    meaning: str
    ids: tuple[str, ...]
    columns: tuple[Column, ...]

    @property
    def word(self) -> str:
        """First word of its channels: `deforc` of the group `deforc-linear`."""
        return self.name.partition("-")[0]


@dataclass(frozen=True)
class Channel:
    """One time history: one column of one entity."""

    name: str
    unit: str
    meaning: str
    samples: int


class Result:
    """The result of one run; raises PostError when it cannot be read."""

    def __init__(self, path: Path | str) -> None:
        """Open `path`, a results folder or the history.h5 in one."""
        path = Path(path)
        self.file = path if path.suffix == ".h5" else path / "history.h5"
        self.folder = self.file.parent
        self._history = self._open()
        self.attributes: dict[str, Any] = dict(self._history.attrs)
        self._check_format()
        try:
            self.families = {name: _family(name, self._history[name]) for name in self._history}
            self.time = _sample_times(self._history)
        except (OSError, KeyError, TypeError, AttributeError) as error:
            raise PostError(f"{self.file}: not as FILE_FORMAT.md has it ({error})") from error

    def channels(self, match: str = "*") -> Iterator[Channel]:
        """All channels whose name fits the shell pattern."""
        for family in self.families.values():
            for entity in family.ids:
                for column in family.columns:
                    name = f"{family.word}.{entity}.{column.name}"
                    if fnmatchcase(name, match):
                        yield Channel(name, column.unit, column.meaning, len(self.time))

    def series(self, expression: str) -> Series:
        """Time, values and unit of a channel, or of arithmetic on channels."""
        try:
            return self._channel(expression.strip())
        except PostError as error:
            if expression.strip().replace(".", "").isidentifier():
                raise
            try:
                return evaluate(expression, self._channel)
            except RecursionError:
                raise PostError("expression nested too deeply") from error

    def block(self, family: Family, column: Column) -> np.ndarray:
        """One quantity of all entities of a family, (n_time, n_id)."""
        return self._read(f"{family.name}/{column.path}", slice(None))

    @cached_property
    def status(self) -> dict[str, Any]:
        """What status.json says, see `read_status`."""
        return read_status(self.folder / "status.json")

    @property
    def finished(self) -> bool:
        """Whether the run reached its end."""
        return self.status.get("state") == "finished"

    @cached_property
    def log(self) -> str:
        """The text of log.txt, empty when there is none."""
        try:
            return (self.folder / "log.txt").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""

    @property
    def deck_text(self) -> str:
        """The deck with includes and parameters resolved."""
        return str(self.attributes.get("deck_text", ""))

    @property
    def title(self) -> str:
        """The deck's title, or the name of the results folder."""
        return str(self.attributes.get("title") or self.folder.resolve().name)

    def stored_json(self, attribute: str) -> Any:
        """A root attribute that holds JSON, None when absent; raises PostError when broken."""
        text = self.attributes.get(attribute)
        try:
            return None if text is None else json.loads(text)
        except (TypeError, ValueError) as error:
            raise PostError(f"{self.file}: attribute '{attribute}' is not JSON: {error}") from error

    def _open(self) -> h5py.File:
        if not self.file.exists():
            raise PostError(f"{self.file}: no such file; name a results folder")
        try:
            return h5py.File(self.file, "r")
        except OSError as error:
            raise PostError(f"{self.file}: not a readable HDF5 file ({error})") from error

    def _check_format(self) -> None:
        if self.attributes.get("format") != FORMAT:
            raise PostError(f"{self.file}: not a {FORMAT} file")
        version = self.attributes.get("format_version")
        if version not in FORMAT_VERSIONS:
            raise PostError(
                f"{self.file}: format version {version}, "
                f"this program reads {FORMAT_VERSIONS[0]} to {FORMAT_VERSIONS[-1]}"
            )

    def _channel(self, name: str) -> Series:
        """The samples of one channel by its exact name."""
        if name == "time":
            return Series(self.time, self.time, "s")
        word, entity, column = _words(name)
        holders = (f for f in self.families.values() if f.word == word and entity in f.ids)
        family = next(holders, None)
        if family is None:
            raise self._unknown_channel(name)
        found = next((c for c in family.columns if c.name == column), None)
        if found is None:
            raise self._unknown_channel(name)
        values = self._read(f"{family.name}/{found.path}", family.ids.index(entity))
        return Series(self.time, values, found.unit)

    def _read(self, path: str, entities: int | slice) -> np.ndarray:
        """The existing rows of a dataset (n_time, n_id), of one entity or of several."""
        try:
            values: np.ndarray = self._history[path][: len(self.time), entities]
        except OSError as error:
            raise PostError(f"{self.file}: '{path}' is damaged ({error})") from error
        return values

    def _unknown_channel(self, name: str) -> PostError:
        """The error for a channel that does not exist, pointing at the first wrong word."""
        word, entity, column = _words(name)
        same = [family for family in self.families.values() if family.word == word]
        if not same:
            known = dict.fromkeys(family.word for family in self.families.values())
            return unknown("family", word, known, whole=name)
        holder = next((family for family in same if entity in family.ids), None)
        if holder is None:
            entities = [entity for family in same for entity in family.ids]
            return unknown(f"{word} entity", entity, entities, whole=name)
        return unknown(f"{word} quantity", column, [c.name for c in holder.columns], whole=name)


def _words(name: str) -> tuple[str, str, str]:
    """Family, entity and quantity.component of a channel name; "" where a word is absent."""
    family, _, rest = name.partition(".")
    entity, _, column = rest.partition(".")
    return family, entity, column


def _family(name: str, group: h5py.Group) -> Family:
    columns: list[Column] = []

    def visit(path: str, item: h5py.Dataset | h5py.Group) -> None:
        if isinstance(item, h5py.Dataset) and path not in ("time", "ids"):
            unit, meaning = item.attrs.get("unit", ""), item.attrs.get("meaning", "")
            columns.append(Column(path, str(unit), str(meaning)))

    group.visititems(visit)
    meaning, ids = str(group.attrs.get("meaning", "")), tuple(group["ids"].asstr()[:])
    return Family(name, meaning, ids, tuple(columns))


def _sample_times(file: h5py.File) -> np.ndarray:
    """The sample times all families share, without the rows reserved for later."""
    first = next(iter(file.values()), None)
    time: np.ndarray = np.empty(0) if first is None else first["time"][:]
    return np.extract(np.isfinite(time), time)
