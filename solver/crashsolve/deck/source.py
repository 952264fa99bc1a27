"""YAML text as plain tables and lists that know where each key and value stands.

Scalars follow the YAML 1.2 core schema: 1e5 is a number, on and yes are text. What could be
misread is refused: 010, .nan, .inf, doubled keys, tags, several documents, recursive aliases.
References: YAML 1.2.2 (2021), sections 10.2 and 10.3.
"""

import math
import re
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, NamedTuple, NoReturn

import yaml

from crashsolve.channels.units import COMMAS
from crashsolve.foundation.errors import DeckError

MAX_DEPTH = 60
MAX_VALUES = 1_000_000
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_CORE_TAG = "tag:yaml.org,2002:"

_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_OTHER_BASE = re.compile(r"0x[0-9a-fA-F]+|0o[0-7]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
# a key without the space that its value needs
_GLUED = re.compile(r"\s*(- )?[\w-]+:[^\s/]")
_DIGITS = re.compile(r"[0-9]+")
_LEADING_ZERO = re.compile(r"[-+]?0[0-9]+")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS: dict[str, bool | None] = {"": None, "~": None, "null": None, "Null": None, "NULL": None}
_WORDS |= {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}


_CORE_TYPES: dict[str, type | UnionType] = {
    "int": int,
    "float": int | float,
    "bool": bool,
    "null": NoneType,
}
# characters that YAML cannot have: another pattern would take another 4 ms of every start
_FORBIDDEN = yaml.reader.Reader.NON_PRINTABLE


# characters that an escape such as "\\e" may bring in; others are spelt out where they are shown
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\ud800-\udfff]")


# names of entries: parts of channels and of files
NAME = re.compile(r"[^\W\d][\w-]*")
KEY_ADVICE = f"put it in quotes; in a number, {COMMAS}"
NAME_ADVICE = "begin with a letter, continue with letters, digits, _ and -"


class _Broken:
    """Stands for a value whose error is already reported."""


BROKEN = _Broken()


class Position(NamedTuple):
    """Position in a file; lines and columns count from 1."""

    file: str
    line: int
    column: int


class Table(dict[str, Any]):
    """A mapping, with the positions of each key and of its value."""

    __slots__ = ("file", "keys_at", "values_at")

    def __init__(self, file: str) -> None:
        super().__init__()
        self.file = file
        self.keys_at: dict[str, tuple[int, int]] = {}
        self.values_at: dict[str, tuple[int, int]] = {}

    def put(self, key: str, value: object, key_at: tuple[int, int], at: tuple[int, int]) -> None:
        """Add a value and its positions."""
        self[key] = value
        self.keys_at[key] = key_at
        self.values_at[key] = at

    def key_location(self, key: str) -> Position:
        """Line and column of a key."""
        return Position(self.file, *self.keys_at[key])

    def value_location(self, key: str) -> Position:
        """Line and column of the value of a key; of the key for a table or list below it."""
        is_block = isinstance(self[key], Table | Rows)
        return self.key_location(key) if is_block else Position(self.file, *self.values_at[key])


class Rows(list[Any]):
    """A sequence, with the position of each value."""

    __slots__ = ("file", "values_at")

    def __init__(self, file: str) -> None:
        super().__init__()
        self.file = file
        self.values_at: list[tuple[int, int]] = []

    def location(self, i: int) -> Position:
        """Line and column of a value."""
        return Position(self.file, *self.values_at[i])


def locate(start: Position, value: object, path: tuple[str | int, ...], key: bool) -> Position:
    """Position of the value at a path, or of its key; as far as the path can be followed."""
    for step in path:
        if isinstance(value, Table) and isinstance(step, str) and step in value:
            start = value.key_location(step) if key else value.value_location(step)
            value = value[step]
        elif isinstance(value, Rows) and isinstance(step, int) and step < len(value):
            start, value = value.location(step), value[step]
        else:
            break
    return start


def read_yaml(path: Path, diagnostics: list[DeckError]) -> Table | None:
    """The table in a file, None when it cannot be read; appends its errors to `errors`."""
    name = str(path)
    try:
        name.encode()
    except UnicodeEncodeError:
        message = "the name of the file is not UTF-8"
        diagnostics.append(DeckError(name, None, None, "", message, "rename it"))
        return None
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        advice = "save the file as UTF-8"
        diagnostics.append(DeckError(name, line, None, "", "this is not UTF-8 text", advice))
        return None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        diagnostics.append(DeckError(name, None, None, "", f"the file cannot be read: {reason}"))
        return None
    return parse_yaml(text, name, diagnostics)


def parse_yaml(text: str, name: str, diagnostics: list[DeckError]) -> Table | None:
    """The table a YAML text holds; `name` is the file in messages."""
    bad = _FORBIDDEN.search(text)
    if bad is not None:
        line = text.count("\n", 0, bad.start()) + 1
        column = bad.start() - text.rfind("\n", 0, bad.start())
        message = f"the character U+{ord(bad[0]):04X} is not allowed"
        diagnostics.append(DeckError(name, line, column, "", message))
        return None
    parser = _Parser(name, text, diagnostics)
    try:
        return parser.deck()
    except yaml.MarkedYAMLError as error:
        diagnostics.append(_syntax_error(name, text, error))
    except _Abandoned:
        pass
    return None


def _syntax_error(name: str, text: str, error: yaml.MarkedYAMLError) -> DeckError:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line, mark.column) if mark else (0, 0)
    problem = " ".join(filter(None, (error.context, error.problem)))
    advice = ""
    rows = text.split("\n")
    character = rows[line][column : column + 1] if line < len(rows) else ""
    if "cannot start any token" in problem:
        problem = (
            "a tab cannot indent"
            if character == "\t"
            else f"a value cannot begin with '{character}'"
        )
        advice = "use spaces" if character == "\t" else "put it in quotes"
    elif "mapping values are not allowed" in problem:
        problem = "a ':' is not expected here"
        advice = "check the indentation, or put the text in quotes"
        glued = [k for k in (line - 1, line) if k >= 0 and _GLUED.match(rows[k])]
        if glued:
            advice = f"put a space after the ':' in line {glued[0] + 1}"
    elif "did not find expected" in problem and error.context_mark:
        problem, advice = _unfinished(problem, error.context_mark)
    return DeckError(name, line + 1, column + 1, "", f"not valid YAML: {problem}", advice)


def _unfinished(problem: str, begin: yaml.Mark) -> tuple[str, str]:
    """Message and advice where a table or list that began at a mark does not go on."""
    where = f"began in line {begin.line + 1}, column {begin.column + 1}"
    if "flow" in problem:
        bracket = "{" if "mapping" in problem else "["
        return (
            f"the '{bracket}' that {where} is not closed before this",
            "check brackets, commas and quotes",
        )
    kind = "table" if "mapping" in problem else "list"
    return (
        f"this does not continue the {kind} that {where}",
        "indent its entries alike, and check quotes",
    )


class _Abandoned(Exception):
    """The rest of the file cannot be made sense of; the reason is among the errors."""


class _Parser:
    """Builds tables and lists from the events of the YAML parser."""

    def __init__(self, name: str, text: str, diagnostics: list[DeckError]) -> None:
        self.name = name
        self.loader = _LOADER(text)
        self.diagnostics = diagnostics
        self.anchors: dict[str, tuple[object, int]] = {}
        self.count = 0

    def refuse(self, event: yaml.Event, message: str, advice: str = "") -> object:
        line, column = _position(event)
        self.diagnostics.append(DeckError(self.name, line, column, "", message, advice))
        return BROKEN

    def refuse_tag(self, event: yaml.ScalarEvent | yaml.CollectionStartEvent) -> object:
        name = (event.tag or "").replace(_CORE_TAG, "!!")
        return self.refuse(event, f"the tag '{name}' is not allowed")

    def abandon(self, event: yaml.Event, message: str, advice: str = "") -> NoReturn:
        self.refuse(event, message, advice)
        raise _Abandoned

    def deck(self) -> Table:
        self.loader.get_event()
        start = self.loader.get_event()
        if isinstance(start, yaml.StreamEndEvent):
            self.abandon(start, "the file is empty")
        first = self.loader.get_event()
        value = self.node(first, 0)
        self.loader.get_event()
        end = self.loader.get_event()
        if not isinstance(end, yaml.StreamEndEvent):
            self.abandon(end, "a second document begins here", "a deck is one document")
        if value is None:
            self.abandon(first, "the file is empty")
        if not isinstance(value, Table):
            self.abandon(first, "a deck is a table of keywords", "begin with 'title: ...'")
        return value

    def node(self, event: yaml.NodeEvent, depth: int) -> object:
        if depth > MAX_DEPTH:
            self.abandon(event, f"nested more than {MAX_DEPTH} deep")
        before = self.count
        self.count += 1
        if isinstance(event, yaml.AliasEvent):
            value = self.alias(event)
        elif isinstance(event, yaml.ScalarEvent):
            value = self.scalar(event)
        else:
            assert isinstance(event, yaml.CollectionStartEvent)
            if event.tag not in (None, "!", _CORE_TAG + "map", _CORE_TAG + "seq"):
                self.refuse_tag(event)
            value = (self.table if isinstance(event, yaml.MappingStartEvent) else self.rows)(depth)
        if self.count > MAX_VALUES:
            advice = "long tables belong in files of their own"
            self.abandon(event, f"the deck has more than {MAX_VALUES} values", advice)
        if event.anchor and not isinstance(event, yaml.AliasEvent):
            self.anchors[event.anchor] = value, self.count - before
        return value

    def alias(self, event: yaml.AliasEvent) -> object:
        if event.anchor not in self.anchors:
            return self.refuse(event, f"no value has the anchor '&{event.anchor}' before this")
        value, size = self.anchors[event.anchor]
        self.count += size
        return value

    def rows(self, depth: int) -> Rows:
        rows = Rows(self.name)
        while not isinstance(event := self.loader.get_event(), yaml.SequenceEndEvent):
            rows.values_at.append(_position(event))
            rows.append(self.node(event, depth + 1))
        return rows

    def table(self, depth: int) -> Table:
        table = Table(self.name)
        merged: list[Table] = []
        while not isinstance(event := self.loader.get_event(), yaml.MappingEndEvent):
            key = self.key(event, depth)
            inner = self.loader.get_event()
            value = self.node(inner, depth + 1)
            if key == "<<" and event.implicit[0]:
                merged += self.merged(event, value)
            elif key is not None and key in table:
                line = table.keys_at[key][0]
                self.refuse(event, f"'{key}' is given twice", f"first in line {line}")
            elif key is not None:
                table.put(key, value, _position(event), _position(inner))
        for other in merged:
            for key in [key for key in other if key not in table]:
                table.put(key, other[key], other.keys_at[key], other.values_at[key])
        return table

    def key(self, event: yaml.NodeEvent, depth: int) -> str | None:
        if isinstance(event, yaml.ScalarEvent):
            if not event.style and _DIGITS.fullmatch(event.value):
                # the rest of 1,000 within brackets
                self.refuse(event, f"the key '{event.value}' is not a word", KEY_ADVICE)
                return None
            word = self.scalar(event)
            if isinstance(word, str) and word:
                return word
            if word is BROKEN:
                return None
            self.refuse(event, f"the key '{event.value}' is not a word", "put it in quotes")
            return None
        self.refuse(event, "a key must be a word")
        self.node(event, depth + 1)
        return None

    def merged(self, event: yaml.Event, value: object) -> list[Table]:
        given = value if isinstance(value, Rows) else [value]
        tables = [table for table in given if isinstance(table, Table)]
        if len(tables) == len(given):
            return tables
        self.refuse(event, "'<<' needs a table, or a list of tables")
        return []

    def scalar(self, event: yaml.ScalarEvent) -> object:
        tag = (event.tag or "").removeprefix(_CORE_TAG)
        bad = _CONTROL.search(event.value)
        if bad is not None:
            return self.refuse(event, f"the character U+{ord(bad[0]):04X} is not allowed")
        if tag in ("str", "!") or (not tag and event.style):
            return event.value
        if tag not in ("", *_CORE_TYPES):
            return self.refuse_tag(event)
        value, problem, advice = plain_scalar(event.value)
        if problem:
            return self.refuse(event, problem, advice)
        if tag and not isinstance(value, _CORE_TYPES[tag]):
            return self.refuse(event, f"'{event.value}' does not match its tag '!!{tag}' says")
        return value


def _position(event: yaml.Event) -> tuple[int, int]:
    mark = event.start_mark
    assert mark is not None
    return mark.line + 1, mark.column + 1


def plain_scalar(text: str) -> tuple[object, str, str]:
    """Value of an unquoted scalar, or its error with advice."""
    if text in _WORDS:
        return _WORDS[text], "", ""
    if text[0] not in "+-.0123456789":
        return text, "", ""
    if _INTEGER.fullmatch(text) and len(text) < 400:
        return int(text), "", ""
    if _OTHER_BASE.fullmatch(text) and len(text) < 300:
        return int(text, 0), "", ""
    if _LEADING_ZERO.fullmatch(text):
        plain = text.lstrip("+-0") or "0"
        return (
            None,
            f"'{text}' begins with a zero",
            f"write {plain}, or put it in quotes",
        )
    if _NOT_FINITE.fullmatch(text) or (_FLOAT.fullmatch(text) and math.isinf(float(text))):
        return None, f"'{text}' is not a finite number", ""
    return (float(text) if _FLOAT.fullmatch(text) else text), "", ""
