"""Claim: schema and manuals say all that the cards say, and nothing else."""

import json
from typing import Any

import pytest

from crashsolve.deck.card import Card
from crashsolve.deck.fields import deck_words, declared
from crashsolve.deck.laws import law_class, package_folder, types_in
from crashsolve.deck.schema import (
    _cards_in,
    _nested_folders,
    equations_markdown,
    json_schema,
    keywords_markdown,
)
from crashsolve.deck.sections import KEYWORDS, SECTIONS, SINGLE

LAWS = [
    (folder, word)
    for folder in [*(section.folder for section in SECTIONS.values()), *_nested_folders()]
    for word in types_in(folder)
]


def references(schema: Any) -> list[str]:
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
    found = [law_class(folder, word) for folder, word in LAWS] + list(SINGLE.values())
    for card in found:
        nested = [_cards_in(info.annotation) for info in card.model_fields.values()]
        found += [inner for group in nested for inner in group if inner not in found]
    return found


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
