"""The files of a results folder: histories by channel name, status, log and deck.

Rows whose time is not a number are reserved by the writer and do not exist yet (FILE_FORMAT.md),
so that a result can be read during its run. Views of it (answers, tables, meshes) are made
from crashpost.results.status import Json
from a History and not by it; `result.py` joins both for scripts.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from crashpost.errors import PostError, unknown
from crashpost.results.extremes import Extremes, Slab, extremes, rows_of_a_slab
from crashpost.results.status import Json, read_status
from crashpost.results.text import plain_text, printable
from crashsolve.channels.expression import evaluate
from crashsolve.channels.series import Series

FORMAT = "crashsolve history"
# the first one has other names for some energies, and reads the same
FORMAT_VERSIONS = (1, 2)
WILDCARDS = frozenset("*?[")
FOREIGN = "not as FILE_FORMAT.md has it"


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


class History:
    """Content of the files of one run; raises PostError when they cannot be read."""

    def __init__(self, path: Path | str) -> None:
        """Open `path`, a results folder or the history.h5 in one."""
        path = Path(path)
        self.file = path if path.suffix == ".h5" else path / "history.h5"
        self.folder = self.file.parent
        if not self.file.exists():
            raise PostError(f"{self.file}: no such file; name a results folder")
        with _readable(self.file, "not a readable HDF5 file"):
            if not self.file.is_file():
                raise PostError(f"{self.file}: no plain file")
            self._history = h5py.File(self.file, "r")
        self._extremes: dict[str, Extremes] = {}
        with _readable(self.file, FOREIGN):
            self.attributes: dict[str, Any] = dict(self._history.attrs)
            self._check_format()
            self.time = self._sample_times()
            self.families = {name: self._family(name) for name in self._history}

    def channels(self, match: str = "*") -> Iterator[Channel]:
        """All channels whose name fits the shell pattern."""
        first = match.partition(".")[0]
        for family in self.families.values():
            # a first word without wildcards rules most families out at once
            if not WILDCARDS & set(first) and family.word != first:
                continue
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

    def slabs(self, family: Family, column: Column) -> Iterator[Slab]:
        """One quantity of all entities of a family, (n, n_id) for some samples after the other."""
        count = rows_of_a_slab(len(family.ids))
        for first in range(0, len(self.time), count):
            rows = slice(first, min(first + count, len(self.time)))
            yield first, self._read(f"{family.name}/{column.path}", slice(None), rows)

    def last(self, family: Family, column: Column) -> np.ndarray:
        """One quantity of all entities of a family (n_id,) at the last sample."""
        rows = slice(len(self.time) - 1, len(self.time))
        return self._read(f"{family.name}/{column.path}", slice(None), rows)[0]

    def extremes(self, family: Family, column: Column) -> Extremes:
        """Least and greatest value of each entity; remembered, as many questions are about them."""
        path = f"{family.name}/{column.path}"
        if path not in self._extremes:
            self._extremes[path] = extremes(self.slabs(family, column), len(family.ids))
        return self._extremes[path]

    def span(self, name: str) -> tuple[float, float]:
        """Least and greatest value of a channel; raises PostError for one that does not exist."""
        family, at, column = self._position(name)
        bounds = self.extremes(family, column)
        return float(bounds.least[at]), float(bounds.greatest[at])

    def has(self, name: str) -> bool:
        """Whether there is a channel of this name."""
        try:
            self._position(name)
        except PostError:
            return False
        return True

    @cached_property
    def status(self) -> Json:
        """Content of status.json, see `read_status`."""
        return read_status(self.folder / "status.json")

    @property
    def finished(self) -> bool:
        """Whether the run reached its end."""
        return self.status.get("state") == "finished"

    @cached_property
    def log(self) -> str:
        """The text of log.txt, empty when there is none."""
        return plain_text(self.folder / "log.txt") or ""

    @property
    def deck_text(self) -> str:
        """The deck with includes and parameters resolved."""
        return str(self.attributes.get("deck_text", ""))

    @cached_property
    def chosen_channels(self) -> list[str]:
        """Patterns of the channels that the run was to write; none where it wrote all."""
        return [printable(str(one)) for one in self.stored_json("channels", list) or ()]

    @property
    def title(self) -> str:
        """The deck's title, or the name of the results folder."""
        title = self.attributes.get("title")
        return printable(title if isinstance(title, str) and title else self.folder.resolve().name)

    def stored_json(self, attribute: str, kind: type = object) -> Any:
        """Value of a root attribute in JSON, None when absent; raises PostError when broken."""
        text = self.attributes.get(attribute)
        try:
            content = None if text is None else json.loads(text)
        except (TypeError, ValueError, RecursionError) as error:
            raise PostError(f"{self.file}: attribute '{attribute}' is not JSON: {error}") from error
        if content is not None and not isinstance(content, kind):
            raise PostError(f"{self.file}: attribute '{attribute}' is no {kind.__name__}")
        return content

    def _family(self, name: str) -> Family:
        """A group of the history. Raises PostError, or the exception of h5py for a damaged file."""
        if self._history.get(name, getclass=True, getlink=True) is not h5py.HardLink:
            raise PostError(
                f"{self.file}: '{name}' is a link to another place in the files, not a group"
            )
        group, columns = self._history[name], list[Column]()
        ids = tuple(map(printable, self._whole(group["ids"], 1).asstr()[:]))

        def visit(path: str, item: h5py.Dataset | h5py.Group) -> None:
            if isinstance(item, h5py.Dataset) and path not in ("time", "ids"):
                rows, width = self._whole(item, 2).shape
                if item.dtype.kind != "f" or width != len(ids) or rows < len(self.time):
                    raise PostError(f"{self.file}: '{name}/{path}' does not fit its entities")
                words = (str(item.attrs.get(word, "")) for word in ("unit", "meaning"))
                columns.append(Column(printable(path), *map(printable, words)))

        group.visititems(visit)
        return Family(name, printable(str(group.attrs.get("meaning", ""))), ids, tuple(columns))

    def _sample_times(self) -> np.ndarray:
        """The sample times all families share, without the rows reserved for later."""
        name = next(iter(self._history), None)
        if name is None:
            return np.empty(0)
        dataset = self._whole(self._history[name]["time"], 1)
        if dataset.dtype.kind != "f":
            raise PostError(f"{self.file}: the times of the samples are no numbers")
        time: np.ndarray = dataset[:].astype(float)
        time = time[: np.count_nonzero(np.isfinite(time))]
        # reserved rows come last, and times increase
        if not np.isfinite(time).all() or not (np.diff(time) > 0.0).all():
            raise PostError(f"{self.file}: the times of the samples are damaged")
        return time

    def _whole(self, dataset: h5py.Dataset | h5py.Group | h5py.Datatype, axes: int) -> h5py.Dataset:
        """The dataset itself, which must lie in this file with all that it claims to hold."""
        name = f"{self.file}: '{dataset.name}'"
        if not isinstance(dataset, h5py.Dataset) or len(dataset.shape or ()) != axes:
            raise PostError(f"{name} is no dataset of {axes} axes")
        if dataset.external or dataset.is_virtual:
            raise PostError(f"{name} lies in another file")
        if dataset.nbytes > self.file.stat().st_size:
            raise PostError(f"{name} claims more numbers than the file has room for")
        return dataset

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
        family, at, column = self._position(name)
        return Series(self.time, self._read(f"{family.name}/{column.path}", at), column.unit)

    def _position(self, name: str) -> tuple[Family, int, Column]:
        """Position of a channel: family, number of the entity, column. Raises PostError."""
        word, entity, path = _words(name)
        for family in self.families.values():
            if family.word == word and entity in family.ids:
                for column in family.columns:
                    if column.name == path:
                        return family, family.ids.index(entity), column
                break
        raise self._unknown_channel(name)

    def _read(self, path: str, entities: int | slice, rows: slice | None = None) -> np.ndarray:
        """The existing rows of a dataset (n_time, n_id), of one entity or of several."""
        with _readable(self.file, f"'{path}' is damaged"):
            values: np.ndarray = self._history[path][rows or slice(len(self.time)), entities]
            if not np.isfinite(values).all():
                raise PostError(
                    f"{self.file}: '{path}' is damaged: it has values that are no numbers"
                )
        return values

    def _unknown_channel(self, name: str) -> PostError:
        """The error for a channel that does not exist, pointing at the first wrong word."""
        if self.chosen_channels:
            near = get_close_matches(name, (c.name for c in self.channels()), n=1, cutoff=0.9)
            return PostError(
                f"'{name}' is not in the history, for which output.history.channels chose "
                + ", ".join(self.chosen_channels)
                + (f"; did you mean '{near[0]}'?" if near else "")
            )
        word, entity, column = _words(name)
        same = [family for family in self.families.values() if family.word == word]
        if not same:
            known = dict.fromkeys(family.word for family in self.families.values())
            return unknown("family", word, known, whole=name)
        holder = next((family for family in same if entity in family.ids), None)
        others = sorted({f.word for f in self.families.values() if entity in f.ids})
        if holder is None and others:
            return PostError(f"'{name}': no {word} of '{entity}', which has {' and '.join(others)}")
        if holder is None:
            entities = [entity for family in same for entity in family.ids]
            return unknown(f"{word} entity", entity, entities, whole=name)
        return unknown(f"{word} quantity", column, [c.name for c in holder.columns], whole=name)


def _words(name: str) -> tuple[str, str, str]:
    """Family, entity and quantity.component of a channel name; "" where a word is absent."""
    family, _, rest = name.partition(".")
    entity, _, column = rest.partition(".")
    return family, entity, column


@contextmanager
def _readable(file: Path, what: str) -> Iterator[None]:
    """One error for whatever HDF5, h5py and numpy raise over a damaged file."""
    try:
        yield
    except PostError:
        raise
    except Exception as error:
        reason = str(error).strip().split("\n")[0] or type(error).__name__
        raise PostError(f"{file}: {what} ({reason})") from error
