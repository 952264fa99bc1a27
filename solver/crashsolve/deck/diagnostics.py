"""Errors of a card, with advice, in plain English.

pydantic finds the errors; here they get their words and the position within the card.
"""

import re
from collections.abc import Mapping
from itertools import groupby
from typing import Any, NamedTuple, NoReturn

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from crashsolve.deck.fields import Declared, deck_words, declared, in_unit
from crashsolve.deck.source import BROKEN
from crashsolve.deck.words import choices, listed, meant_field, nearest

Path = tuple[str | int, ...]

EXPECTED = {
    "string_type": "text",
    "bool_type": "true or false",
    "int_type": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "tuple_type": "a list",
    "model_type": "a table of fields",
    "dict_type": "a table",
}


UNKNOWN = "unknown field"


class Diagnostic(NamedTuple):
    """An error at a path within a card; `key` when it is in the name there, not in its value."""

    path: Path
    message: str
    advice: str = ""
    key: bool = False

    @property
    def is_missing(self) -> bool:
        """Whether a field is missing, which counts only where the type of the card is certain."""
        return self.message.startswith("missing field")


def refuse(message: str, advice: str = "", within: Path = (), key: bool = False) -> NoReturn:
    """Refuse the value being read; `within` is the path below it."""
    notes = {"message": message, "advice": advice, "within": within, "key": key}
    raise PydanticCustomError("diagnostic", "{message}", notes)


def already_reported() -> NoReturn:
    """Skip a value whose error has been reported already."""
    raise PydanticCustomError("reported", "already reported")


def shown(value: object) -> str:
    """A value as a message quotes it."""
    if value is None:
        return "empty"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.6g}" if isinstance(value, float) or abs(value) < 1e300 else "a huge number"
    if isinstance(value, str):
        return f"'{value}'" if len(value) < 40 else f"'{value[:36]}...'"
    return "a table" if isinstance(value, Mapping) else "a list"


def diagnostics_of(card: type[BaseModel], error: ValidationError) -> list[Diagnostic]:
    """The errors found in a card, one for each location, in words."""
    diagnostics: dict[Path, Diagnostic] = {}
    lines = [line for line in error.errors(include_url=False) if not _is_reported(line)]
    for word, group in groupby(lines, key=lambda line: line["loc"][:1]):
        for diagnostic in _of_field(card, word, list(group)):
            diagnostics[diagnostic.path] = diagnostic
    # a missing field that stands there misspelt is one mistake
    unknown = [path for path, one in diagnostics.items() if one.message.startswith(UNKNOWN)]
    names = deck_words(card)
    for path in [(*path[:-1], meant_field(path[-1], names)) for path in unknown if len(path) == 1]:
        if path in diagnostics and diagnostics[path].is_missing:
            del diagnostics[path]
    return list(diagnostics.values())


def explained(card: type[BaseModel], error: ValidationError) -> ValidationError:
    """The error of a card with the messages of its parts in words."""
    return reported(diagnostics_of(card, error), card.__name__)


def reported(diagnostics: list[Diagnostic], title: str = "card") -> ValidationError:
    """The error that carries these errors."""
    lines = []
    for diagnostic in diagnostics:
        words = PydanticCustomError(
            "diagnostic", "{message}", diagnostic._asdict() | {"within": ()}
        )
        lines.append(InitErrorDetails(type=words, loc=diagnostic.path, input=None))
    # a card whose errors are all known must still be refused
    known = PydanticCustomError("reported", "already reported")
    lines = lines or [InitErrorDetails(type=known, input=None)]
    return ValidationError.from_exception_data(title, lines)


def _is_reported(line: ErrorDetails) -> bool:
    return line["type"] == "reported" or line["input"] is BROKEN


def _of_field(card: type[BaseModel], word: Path, lines: list[ErrorDetails]) -> list[Diagnostic]:
    name = deck_words(card).get(str(word[0])) if word else None
    if name is None:
        return [_in_words(card, None, line) for line in lines]
    field = declared(card, name)
    if len(field.parts) == 1 or any(line["type"] == "diagnostic" for line in lines):
        return [_in_words(card, field, line) for line in lines]
    # the members of a union each complain: the deepest complaint is to the point, else all are one
    deepest = max(lines, key=lambda line: len(line["loc"]))
    if len(deepest["loc"]) > 2:
        location = deepest["loc"][:1] + deepest["loc"][2:]
        return [_in_words(card, field, deepest)._replace(path=location)]
    wanted = " or ".join(dict.fromkeys(_expected(field, line) for line in lines))
    return [Diagnostic(word, f"must be {wanted}, not {shown(lines[0]['input'])}")]


def _in_words(card: type[BaseModel], field: Declared | None, line: ErrorDetails) -> Diagnostic:
    path, value = line["loc"], line["input"]
    notes: dict[str, Any] = line.get("ctx", {})
    match line["type"]:
        case "diagnostic":
            path = (*path, *notes["within"])
            return Diagnostic(path, notes["message"], notes["advice"], notes["key"])
        case "value_error":
            return _from_rule(path, str(notes["error"]))
        case "extra_forbidden":
            advice = choices(path[-1], deck_words(card), "fields")
            return Diagnostic(path, f"{UNKNOWN} '{path[-1]}'", advice, key=True)
        case "missing" if isinstance(path[-1], int):
            return Diagnostic(path[:-1], f"must have {path[-1] + 1} values, not {len(value)}")
        case "missing":
            return Diagnostic(path, f"missing field '{path[-1]}'{_described(field)}", key=True)
        case "too_long":
            wanted, given = notes["max_length"], notes["actual_length"]
            return Diagnostic(path, f"must have {wanted} values, not {given}")
        case "literal_error":
            words = [word for word in field.words if isinstance(word, str)] if field else []
            advice = nearest(value, words)
            return Diagnostic(path, f"must be {notes['expected']}, not {shown(value)}", advice)
    return Diagnostic(
        path, f"must be {_expected(field, line)}, not {shown(value)}", _hint(card, field, line)
    )


def _hint(card: type[BaseModel], field: Declared | None, line: ErrorDetails) -> str:
    """How a value of the wrong kind may be written."""
    if line["type"] == "tuple_type" and _is_entry(field, line["input"]):
        return f"write [{line['input']}]"
    is_card = line["type"] == "model_type" and field is None
    return f"(fields: {listed(deck_words(card))})" if is_card else ""


def _is_entry(field: Declared | None, value: object) -> bool:
    """Whether a text stands where a list of any length should, and may be one of its entries."""
    is_short = isinstance(value, str) and len(value) < 40
    return is_short and field is not None and field.list_in("") == "a list"


def _from_rule(path: Path, text: str) -> Diagnostic:
    """A sentence from a rule of a card; "field: sentence" belongs to that field."""
    match = re.match(r"(\w+): (.*)", text, re.DOTALL)
    return Diagnostic((*path, match[1]), match[2]) if match else Diagnostic(path, text)


def _described(field: Declared | None) -> str:
    if field is None or not field.meaning:
        return ""
    unit = in_unit(field.unit)
    return f" ({field.meaning}{',' if unit else ''}{unit})"


def _expected(field: Declared | None, line: ErrorDetails) -> str:
    kind = line["type"]
    if kind == "literal_error":
        return str(line["ctx"]["expected"])
    unit = in_unit(field.unit) if field else ""
    if kind == "tuple_type" and field:
        depth = sum(isinstance(step, int) for step in line["loc"])
        return field.list_in(field.unit if field.length else "", depth)
    if kind not in EXPECTED:
        return f"valid ({line['msg']})"
    return EXPECTED[kind] + (unit if kind == "float_type" else "")
