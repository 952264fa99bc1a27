"""Claim: schema and manuals say all that the cards say, and nothing else."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from crashsolve.deck.card import Card, law_class
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.keywords import KEYWORDS, SECTIONS, SINGLE
from crashsolve.deck.laws import package_folder, types_in
from crashsolve.deck.schema import (
    _cards_in,
    _nested_folders,
    equations_markdown,
    json_schema,
    keywords_markdown,
)
from crashsolve.deck.source import read_yaml
from crashsolve.model.contact.node_to_surface import PRESSING

LAWS = [
    (folder, word)
    for folder in [*(section.folder for section in SECTIONS.values()), *_nested_folders()]
    for word in types_in(folder)
]


def references(schema: object) -> list[str]:
    """All `$ref` within a schema."""
    if isinstance(schema, dict):
        own = [schema["$ref"]] if "$ref" in schema else []
        return own + [ref for part in schema.values() for ref in references(part)]
    return [ref for part in schema for ref in references(part)] if isinstance(schema, list) else []


def test_the_schema_knows_every_keyword_type_and_field() -> None:
    schema = json_schema()
    json.dumps(schema)
    assert list(schema["properties"]) == list(KEYWORDS)
    for folder, word in LAWS:
        entry = schema["$defs"][f"{folder.replace('/', '.')}.{word}"]
        assert set(entry["properties"]) == {"type", *deck_words(law_class(folder, word))}
        assert entry["additionalProperties"] is False


def test_every_reference_of_the_schema_is_defined() -> None:
    schema = json_schema()
    for reference in references(schema):
        assert reference.removeprefix("#/$defs/") in schema["$defs"]


def test_the_manual_names_every_type_with_its_file() -> None:
    manual = keywords_markdown()
    for folder, word in LAWS:
        path = types_in(folder)[word].relative_to(package_folder().parent).as_posix()
        assert f"### {word} (`{path}`)" in manual


def cards() -> list[type[Card]]:
    """All cards of the deck language, nested ones too."""
    cards_of_laws = [law_class(folder, word) for folder, word in LAWS] + list(SINGLE.values())
    for card in cards_of_laws:
        nested = [_cards_in(info.annotation) for info in card.model_fields.values()]
        cards_of_laws += [
            inner for group in nested for inner in group if inner not in cards_of_laws
        ]
    return cards_of_laws


@pytest.mark.parametrize("card", cards(), ids=lambda card: card.__name__)
def test_every_field_has_a_meaning_and_every_card_a_sentence(card: type[Card]) -> None:
    assert (card.__doc__ or "").strip().endswith(".")
    without = [word for word, name in deck_words(card).items() if not declared(card, name).meaning]
    assert not without


@pytest.mark.parametrize("card", cards(), ids=lambda card: card.__name__)
def test_every_default_is_a_value_the_card_accepts(card: type[Card]) -> None:
    for word, name in deck_words(card).items():
        info = card.model_fields[name]
        if not info.is_required() and info.default is not None:
            errors: list[Any] = []
            try:
                card.model_validate({word: info.default})
            except ValueError as error:
                errors = [line["loc"] for line in error.errors()]  # type: ignore[attr-defined]
            assert (word,) not in [tuple(loc[:1]) for loc in errors]


def test_the_equations_name_files_that_cite_them() -> None:
    index = equations_markdown()
    assert "## Ambrosio (2003)" in index
    for number in (17, 18, 19, 20):
        row = next(line for line in index.splitlines() if line.startswith(f"| {number} |"))
        assert "contact/normal/lankarani_nikravesh.py" in row


KINDS: dict[str, Any] = {
    "object": dict,
    "array": list,
    "string": str,
    "integer": int,
    "number": int | float,
    "boolean": bool,
    "null": type(None),
}
BOUNDS = {
    "minimum": lambda x, limit: x >= limit,
    "exclusiveMinimum": lambda x, limit: x > limit,
    "maximum": lambda x, limit: x <= limit,
    "exclusiveMaximum": lambda x, limit: x < limit,
    "minItems": lambda x, limit: len(x) >= limit,
    "maxItems": lambda x, limit: len(x) <= limit,
}


def is_kind(value: object, kind: str) -> bool:
    return isinstance(value, KINDS[kind]) and (kind == "boolean" or not isinstance(value, bool))


def faults(value: object, schema: Any, root: Any, path: str = "") -> Iterator[str]:
    """Where a value breaks a schema, by the rules of JSON Schema 2020-12 that the schema uses."""
    known = {"$ref", "type", "enum", "const", "anyOf", "allOf", "if", "then", "else", "not"}
    known |= {"properties", "required", "additionalProperties", "items", "description", *BOUNDS}
    assert set(schema) <= known | {"$schema", "$defs", "title"}
    if "$ref" in schema:
        yield from faults(value, root["$defs"][schema["$ref"].rpartition("/")[2]], root, path)
    kinds = schema.get("type", list(KINDS))
    if not any(is_kind(value, kind) for kind in ([kinds] if isinstance(kinds, str) else kinds)):
        yield f"{path}: is no {kinds}"
        return
    if value not in schema.get("enum", [value]) or value != schema.get("const", value):
        yield f"{path}: {value!r} is none of {schema.get('enum', schema.get('const'))}"
    if "anyOf" in schema and all(any(faults(value, s, root)) for s in schema["anyOf"]):
        yield f"{path}: is none of anyOf"
    if "not" in schema and not any(faults(value, schema["not"], root)):
        yield f"{path}: is what it must not be"
    for part in schema.get("allOf", []):
        yield from faults(value, part, root, path)
    if "if" in schema:
        branch = "else" if any(faults(value, schema["if"], root)) else "then"
        yield from faults(value, schema.get(branch, {}), root, path)
    for word, holds in BOUNDS.items():
        is_meant = word in schema and is_kind(value, "array" if "Items" in word else "number")
        if is_meant and not holds(value, schema[word]):
            yield f"{path}: {word} is {schema[word]}"
    if isinstance(value, dict):
        yield from (f"{path}.{w}: is missing" for w in schema.get("required", []) if w not in value)
        for word, part in value.items():
            own = schema.get("properties", {}).get(word, schema.get("additionalProperties", {}))
            if own is False:
                yield f"{path}.{word}: is unknown"
            else:
                yield from faults(part, own, root, f"{path}.{word}")
    if isinstance(value, list):
        for i, part in enumerate(value):
            yield from faults(part, schema.get("items", {}), root, f"{path}.{i}")


DECKS = [
    path
    for path in sorted((Path(__file__).parents[2] / "decks").rglob("*.yaml"))
    if not path.name.endswith((".plan.yaml", ".posture.yaml"))
]


def test_every_deck_keeps_to_the_schema() -> None:
    schema = json_schema()
    # what an include fills in is none of the words yet
    filled_in = re.compile(r": '[^']*<\w+>[^']*' is none of")
    for path in DECKS:
        faults_of_deck = faults(read_yaml(path, []), schema, schema, path.name)
        assert [fault for fault in faults_of_deck if not filled_in.search(fault)] == []


@pytest.mark.parametrize(
    ("text", "field"),
    [
        (
            "springs: {s: {type: linear, b: x, stifness: 1, stiffness: 1}}",
            "springs.s.stifness: is unknown",
        ),
        ("springs: {s: {type: lineer, b: x}}", "springs.s.type: 'lineer' is none of"),
        ("springs: {s: {b: x}}", "springs.s.type: is missing"),
        (
            "bodies: {b: {mass: true, inertia: [1, 1, 1]}}",
            "bodies.b.mass: is no ['number', 'string', 'null']",
        ),
        (
            "bodies: {b: {mass: 1, inertia: [1, 1, 1], friction: 1}}",
            "bodies.b.friction: is unknown",
        ),
        (
            "contacts: {c: {a: [x], b: [y], normal: {type: hertz, exponent: []}}}",
            "contacts.c.normal.exponent: is no",
        ),
        (
            "contacts: {c: {a: [x], b: [y], normal: {type: hertz}, friction: {type: coulomb}}}",
            "contacts.c.friction.friction_coefficient: is missing",
        ),
        ("contacts: {c: {a: [x], b: [y], normal: 3}}", "contacts.c.normal: is no object"),
        (
            "parts: {p: {type: shell, thickness: 1, material: m, "
            "mesh: {type: file, file: x, elements: 1.5}}}",
            "parts.p.mesh.elements: is no ['string', 'integer']",
        ),
    ],
)
def test_the_schema_points_at_the_field_that_is_wrong(text: str, field: str) -> None:
    schema = json_schema()
    reported = list(faults(yaml.safe_load(text), schema, schema))
    assert [line for line in reported if line.startswith(f".{field}")], reported
    assert len(reported) == 1 or "friction.friction_coefficient" in field


def test_what_may_be_left_empty_may_be_null() -> None:
    schema = json_schema()
    text = "contacts: {c: {a: [x], b: [y], normal: {type: hertz}, friction: null}}"
    text += "\nbodies: {b: {mass: null, inertia: [1, 1, 1], primitive: null}}"
    assert list(faults(yaml.safe_load(text), schema, schema)) == []


def test_the_manual_says_which_surfaces_meet_and_in_how_many_points() -> None:
    manual = keywords_markdown()
    pairs = package_folder() / "contact" / "narrow"
    for path in pairs.glob("[!_]*.py"):
        one, _, other = path.stem.partition("_")
        assert f"| `{one}`, `{other}` | " in manual
    # spheres stand for point sets and nodes of beams, points are the nodes of shells
    assert PRESSING[1] == ("points", "sphere", "ellipsoid")
    assert "that touch `faces`: `nodes`, `sphere`, `point_set`, `ellipsoid`" in manual
    assert PRESSING[0] == ("points", "sphere")
