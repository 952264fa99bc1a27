"""The deck language as a JSON Schema for editors, and as two manuals, all from the cards.

KEYWORDS.md lists all fields; EQUATIONS.md lists the file of each equation.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import AfterValidator, BeforeValidator

from crashsolve.deck.card import Card, Reference, existing_file, law_class, number_as_name
from crashsolve.deck.fields import BOUNDS, Declared, deck_words, declared
from crashsolve.deck.keywords import KEYWORDS, LISTS, SECTIONS, SINGLE
from crashsolve.deck.laws import PACKAGE, package_folder, types_in
from crashsolve.deck.reading.expressions import FUNCTIONS

Schema = dict[str, Any]
_SCALARS: dict[object, Schema] = {
    float: {"type": ["number", "string"]},
    # a whole number may be an expression
    int: {"type": ["integer", "string"]},
    bool: {"type": "boolean"},
    str: {"type": "string"},
    NoneType: {"type": "null"},
}
_LIMITS = {
    "gt": "exclusiveMinimum",
    "ge": "minimum",
    "lt": "exclusiveMaximum",
    "le": "maximum",
}


# a file, or one with words put into it
_INCLUDED = {
    "anyOf": [
        {"type": "string"},
        {
            "type": "object",
            "properties": {
                "file": {"type": "string"},
                "with": {"type": "object", "additionalProperties": {"type": ["string", "number"]}},
            },
            "required": ["file"],
            "additionalProperties": False,
        },
    ]
}
SWITCHES = {"off": False, "no": False, "on": True, "yes": True}
# a set of a mesh file may have a number for a name
_SET_NAME = {"type": ["string", "integer"]}


def json_schema() -> Schema:
    """JSON Schema (2020-12) of a whole deck, with all types of all families."""
    cards = _Definitions()
    keywords: Schema = {
        "title": {"type": "string"},
        "include": {"anyOf": [_INCLUDED, {"type": "array", "items": _INCLUDED}]},
        "parameters": {"additionalProperties": {"type": ["number", "string"]}},
    }
    for keyword, card in SINGLE.items():
        keywords[keyword] = cards.card(card)
    for keyword, card in LISTS.items():
        keywords[keyword] = {"type": "array", "items": cards.card(card)}
    for keyword, section in SECTIONS.items():
        entries = cards.laws(section.folder, section.default)
        keywords[keyword] = {"type": ["object", "null"], "additionalProperties": entries}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "crashsolve deck",
        "type": "object",
        "properties": {keyword: keywords[keyword] for keyword in KEYWORDS},
        "additionalProperties": False,
        "$defs": cards.definitions,
    }


class _Definitions:
    """Schemas of cards, each once, referred to by name."""

    def __init__(self) -> None:
        self.definitions: Schema = {}

    def laws(self, folder: str, default: str = "") -> Schema:
        """Any type of a family."""
        words = list(types_in(folder))
        if not words:
            return {"not": {}}
        # one branch alone is checked, so that an error names the field it is in
        branches = []
        for word in words:
            is_it: Schema = {"properties": {"type": {"const": word}}}
            if word != default:
                is_it["required"] = ["type"]
            branches.append({"if": is_it, "then": self.law(folder, word, word == default)})
        return {
            "type": "object",
            "properties": {"type": {"enum": words}},
            "required": [] if default else ["type"],
            "allOf": branches,
        }

    def law(self, folder: str, word: str, is_default: bool) -> Schema:
        name = f"{folder.replace('/', '.')}.{word}"
        if name not in self.definitions:
            schema = self.definitions[name] = {}
            schema |= self.fields(law_class(folder, word))
            schema["properties"] = {"type": {"const": word}, **schema["properties"]}
            schema["required"] = [*([] if is_default else ["type"]), *schema["required"]]
        return {"$ref": f"#/$defs/{name}"}

    def card(self, card: type[Card]) -> Schema:
        name = f"{card.__module__.rpartition('.')[2]}.{card.__name__}"
        if name not in self.definitions:
            self.definitions[name] = {}
            self.definitions[name] |= self.fields(card)
        reference = {"$ref": f"#/$defs/{name}"}
        return {"anyOf": [_SCALARS[str], reference]} if card.shorthand else reference

    def fields(self, card: type[Card]) -> Schema:
        words = {word: declared(card, name) for word, name in deck_words(card).items()}
        return {
            "type": "object",
            "description": _sentence(card),
            "properties": {word: self.field(field) for word, field in words.items()},
            "required": [word for word, field in words.items() if field.info.is_required()],
            "additionalProperties": False,
        }

    def field(self, field: Declared) -> Schema:
        schema = self.laws(field.law) if field.law else self.kind(field.info.annotation, field)
        if field.law and field.optional:
            schema = {"if": {"type": "object"}, "then": schema, "else": _SCALARS[NoneType]}
        elif _is_set_name(field.info.metadata):
            schema = _SET_NAME
        meaning = " ".join(filter(None, (field.meaning, f"[{field.unit}]" if field.unit else "")))
        return {**schema, "description": meaning} if meaning else schema

    def kind(self, annotation: Any, field: Declared) -> Schema:
        """Schema of an annotation; bounds that no unit can change come along."""
        origin, parts = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return _SET_NAME if _is_set_name(parts[1:]) else self.kind(parts[0], field)
        if origin is Literal:
            # editors that read YAML 1.1 take off and on for false and true
            plain = [SWITCHES[part] for part in parts if part in SWITCHES]
            return {"enum": [*parts, *plain]}
        if origin is tuple:
            size = {} if Ellipsis in parts else {"minItems": len(parts), "maxItems": len(parts)}
            return {"type": "array", "items": self.kind(parts[0], field), **size}
        if parts:
            some = [self.kind(part, field) for part in parts if part is not NoneType]
            known = some[0] if len(some) == 1 else {"anyOf": some}
            return _or_empty(known) if NoneType in parts else known
        if annotation in _SCALARS:
            fixed = {k: v for k, v in field.bounds.items() if v == 0 or field.unit in ("", "1")}
            is_number = annotation in (int, float)
            limits = {_LIMITS[k]: v for k, v in fixed.items()} if is_number else {}
            return _SCALARS[annotation] | limits
        return self.card(annotation)


def _or_empty(schema: Schema) -> Schema:
    """The schema of a value that may be left empty, without a choice that would hide errors."""
    if "type" in schema:
        kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        return schema | {"type": [*kinds, "null"]}
    if "enum" in schema:
        return {"enum": [*schema["enum"], None]}
    if "$ref" in schema:
        return {"if": {"type": "object"}, "then": schema, "else": _SCALARS[NoneType]}
    return {"anyOf": [schema, _SCALARS[NoneType]]}


def keywords_markdown() -> str:
    """KEYWORDS.md: every keyword, type and field, with unit, default, bounds and meaning."""
    return "\n".join(_manual()) + "\n"


def _functions() -> str:
    return " ".join(f"`{name}`" for name in FUNCTIONS)


def _manual() -> Iterator[str]:
    yield from (
        "# Keywords",
        "",
        "Generated from the cards; do not edit. Bare numbers are in SI and radians, or in the",
        "`units` of their file; `54 km/h` and `${speed/3.6}` may stand for any number.",
        "Where a file has `units`, an expression of parameters with units may hold bare numbers",
        "if these are pure, as in `${length/2}`, or if the units of the others cancel, as in",
        "`${gap*sin(tilt)}`.",
        "A parameter without a unit is in the units of the file that defines it: a file with",
        "other units may read it only where it is pure; `'4 1'` states that it is.",
        "Expressions have `+ - * / **`, `pi` and the functions " + _functions() + ";",
        "`${within(stature, 0.5, 2.3)}` is the stature, and refuses one outside these limits.",
        "`title` is text, `include` a list of files, `parameters` a table of names and numbers.",
        "A file may be included many times with other words: with",
        "`{file: car.yaml, with: {car: c1}}` every `<car>` in its names and texts becomes `c1`.",
        "A field without a default must be given.",
    )
    nested: dict[type[Card], None] = {}
    for keyword in KEYWORDS:
        if keyword in SINGLE | LISTS:
            yield from _section(keyword, f"## {keyword}", (SINGLE | LISTS)[keyword], nested)
        elif keyword in SECTIONS and types_in(SECTIONS[keyword].folder):
            section = SECTIONS[keyword]
            default = f" `type` is `{section.default}` when absent." if section.default else ""
            yield from ("", f"## {keyword}", "", f"A table of names.{default}")
            yield from _family(section.folder, nested)
            if keyword == "surfaces":
                yield from _pairs_of_shapes()
    for folder in _nested_folders():
        yield from ("", f"## Laws of {folder}")
        yield from _family(folder, nested)
    if nested:
        yield from ("", "## Tables within cards")
    done: set[type[Card]] = set()
    while todo := [card for card in nested if card not in done]:
        for card in todo:
            done.add(card)
            yield from _section(card.__name__, f"### {card.__name__}", card, nested)


def _family(folder: str, nested: dict[type[Card], None]) -> Iterator[str]:
    for word, path in types_in(folder).items():
        file = path.relative_to(package_folder().parent).as_posix()
        yield from _section(word, f"### {word} (`{file}`)", law_class(folder, word), nested)


def _pairs_of_shapes() -> Iterator[str]:
    """Shapes that can touch, and their number of points, by the files of contact/narrow."""
    files = sorted((package_folder() / "contact" / "narrow").glob("[!_]*.py"))
    shells = ", ".join(f"`{shape}`" for shape in ("nodes", "sphere", "point_set", "ellipsoid"))
    yield from (
        "",
        "### Pairs of surfaces",
        "",
        "Pairs of shapes that can touch, in either order, and their contact points.",
        "`point_set` and `nodes` touch other shapes as `sphere` does, each point by itself. Shapes",
        f"that touch `faces`: {shells}, each node,",
        "sphere or ellipsoid in one point.",
        "",
        "| surfaces | points |",
        "|---|---|",
    )
    for path in files:
        one, _, other = path.stem.partition("_")
        yield f"| `{one}`, `{other}` | {_points_of_pair(path.stem)} |"


def _points_of_pair(pair: str) -> str:
    """POINTS of the pair's file or of the file of its kernel, else the first line of its
    docstring.
    """
    module = import_module(f"{PACKAGE}.contact.narrow.{pair}")
    home = import_module(module.gap.__module__)
    stated = getattr(module, "POINTS", getattr(home, "POINTS", ""))
    first = (module.__doc__ or "").splitlines()[0]
    return str(stated) or first.partition(", ")[2].strip(".") or "one"


def _section(
    word: str, heading: str, card: type[Card], nested: dict[type[Card], None]
) -> Iterator[str]:
    yield from ("", heading, "", _sentence(card), "")
    yield from (
        "| field | value | unit | default | bounds | meaning |",
        "|---|---|---|---|---|---|",
    )
    for name_in_deck, name in deck_words(card).items():
        field = declared(card, name)
        nested.update(dict.fromkeys(_cards_in(field.info.annotation)))
        bounds = ", ".join(f"{BOUNDS[kind][1]} {limit:g}" for kind, limit in field.bounds.items())
        kind = f"law of {field.law}" if field.law else _kind_of(field)
        if name in card.curve_axes:
            x, y = (unit if unit != "1" else "a number" for unit in card.curve_axes[name])
            kind += f", {y} over {x}"
        cells = (f"`{name_in_deck}`", kind, field.unit, _default(field), bounds, field.meaning)
        yield f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"


def _nested_folders() -> list[str]:
    """Folders of laws that stand within cards, in the order in which they are met."""
    folders: dict[str, None] = {}
    todo = [section.folder for section in SECTIONS.values()]
    while todo:
        folder = todo.pop(0)
        for word in types_in(folder):
            card = law_class(folder, word)
            laws = [declared(card, name).law for name in card.model_fields]
            todo += [law for law in laws if law and law not in folders]
            folders.update(dict.fromkeys(law for law in laws if law))
    return list(folders)


def _sentence(card: type[Card]) -> str:
    """First sentence of a card's docstring."""
    return (card.__doc__ or "").strip().partition("\n\n")[0].replace("\n    ", " ")


def _default(field: Declared) -> str:
    if field.info.is_required():
        return ""
    value = field.info.default
    if isinstance(value, Card):
        return "its defaults"
    if isinstance(value, tuple):
        return str(list(value)) if value else "none"
    if isinstance(value, float):
        return f"{value:g}"
    return "none" if value in (None, "") else str(value)


def _cards_in(annotation: object) -> list[type[Card]]:
    """Cards that an annotation holds."""
    if isinstance(annotation, type) and issubclass(annotation, Card):
        return [] if annotation is Card else [annotation]
    return [card for part in get_args(annotation) for card in _cards_in(part)]


def _kind_of(field: Declared) -> str:
    """Values that a user may write for a field, in words."""
    return _marked(field.info.metadata) or _kind(field.info.annotation)


def _is_set_name(marks: Iterable[object]) -> bool:
    """Whether a text may be written as a whole number."""
    return any(isinstance(m, BeforeValidator) and m.func is number_as_name for m in marks)


def _marked(marks: Iterable[object]) -> str:
    """Meaning of a text by the marks of its annotation: a name, or a file."""
    if _is_set_name(marks):
        return "text or whole number"
    functions = [mark.func for mark in marks if isinstance(mark, AfterValidator)]
    if existing_file in functions:
        return "name of a file"
    names = [mark.keyword for mark in functions if isinstance(mark, Reference)]
    return f"name of a {SECTIONS[names[0]].singular}" if names else ""


def _kind(annotation: Any) -> str:
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _marked(parts[1:]) or _kind(parts[0])
    if origin is Literal:
        return " or ".join(f"`{word}`" for word in parts)
    if origin is tuple and Ellipsis in parts:
        return f"list of {_kind(parts[0])}"
    if origin is tuple:
        same = len(set(parts)) == 1
        return f"{len(parts)} {_kind(parts[0])}s" if same else ", ".join(map(_kind, parts))
    if parts:
        return " or ".join(_kind(part) for part in parts if part is not NoneType)
    words = {float: "number", int: "whole number", bool: "true or false", str: "text"}
    return words.get(annotation) or f"table {annotation.__name__}"


_CITED = re.compile(r"([A-Z][\w.' -]*? \(\d{4}\)), Eqs?\. (\d+(?:(?:-|, | and )\d+)*)")


def equations_markdown() -> str:
    """EQUATIONS.md: which files hold the equations that docstrings cite, by source and number."""
    index: dict[str, dict[int, dict[str, None]]] = {}
    root = package_folder()
    for path in sorted(root.rglob("*.py")):
        for source, number in _citations(path):
            files = index.setdefault(source, {}).setdefault(number, {})
            files[path.relative_to(root.parent).as_posix()] = None
    lines = ["# Equations", "", "Generated from the docstrings; do not edit.", ""]
    lines += ["Equations that are not listed are not in this version."]
    for source, equations in sorted(index.items()):
        lines += ["", f"## {source}", "", "| Eq. | files |", "|---|---|"]
        for number, files in sorted(equations.items()):
            lines.append(f"| {number} | {', '.join(f'`{file}`' for file in files)} |")
    return "\n".join(lines) + "\n"


def _citations(path: Path) -> Iterator[tuple[str, int]]:
    """Source and number of each equation that the docstrings of a file cite."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            continue
        for source, numbers in _CITED.findall(" ".join((ast.get_docstring(node) or "").split())):
            for span in re.split(r", | and ", numbers):
                first, _, last = span.partition("-")
                yield from ((source, n) for n in range(int(first), int(last or first) + 1))
