"""Claim: a law is one file of card, build and kernel, cited, and proved by a deck of its own."""

from importlib import import_module
from pathlib import Path

import pytest

from crashsolve.deck.card import Card, law_class
from crashsolve.deck.family import check_law, constants, families, provided
from crashsolve.deck.keywords import SECTIONS
from crashsolve.deck.laws import types_in
from crashsolve.deck.reading.deck import read_deck
from crashsolve.deck.schema import _nested_folders

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOLDERS = [*(section.folder for section in SECTIONS.values()), *_nested_folders()]
LAWS = [(folder, word) for folder in FOLDERS for word in types_in(folder)]
BY_FOLDER = {family.folder: family for family in families().values()}


@pytest.mark.parametrize("law", LAWS, ids="/".join)
def test_a_law_has_card_build_and_kernels(law: tuple[str, str]) -> None:
    folder, word = law
    if folder == "contact":  # the one card that only brings shapes and laws together
        return
    module = import_module(law_class(folder, word).__module__)
    assert module.__doc__, f"{module.__file__} needs a docstring that begins with its equation"
    card = law_class(folder, word)
    # KEYWORDS.md and the manual state what a card is by its own words, not those of the class above
    assert card.__doc__ and card.__doc__ != card.__mro__[1].__doc__, (
        f"{card.__name__} of {module.__file__} needs a docstring of its own"
    )
    check_law(module)
    if hasattr(module, "expand"):
        return  # written out in other cards: there is nothing of it to build
    assert callable(module.build)
    role = BY_FOLDER[folder].law
    for name in (*provided(role), *constants(role)):
        assert hasattr(module, name)


@pytest.mark.parametrize("word", types_in("loads"))
def test_a_load_names_its_amplitude_for_quasi_static_runs(word: str) -> None:
    # a load without it would act at full size from the first sample on
    module = import_module(law_class("loads", word).__module__)
    assert module.PARAMETERS.dtype[module.AMPLITUDE].base.kind == "f"


def _modules(card: Card) -> set[str]:
    """Modules of a card and of the laws within it."""
    parts = [part for name in type(card).model_fields for part in _cards(getattr(card, name))]
    return {type(card).__module__}.union(*map(_modules, parts))


def _cards(value: object) -> list[Card]:
    values = value if isinstance(value, tuple) else (value,)
    return [part for part in values if isinstance(part, Card)]


def _proved() -> set[str]:
    """Modules of the laws in all decks that expect something."""
    proved: set[str] = set()
    for folder in ("verification", "benchmark"):
        for path in (DECKS / folder).rglob("*.yaml"):
            deck = read_deck(path)
            cards = [entry.card for entries in deck.entries.values() for entry in entries.values()]
            cards += [entry.card for entry in deck.written_out]
            proved = proved.union(*map(_modules, cards)) if deck.expect else proved
    return proved


def test_every_law_is_proved_by_a_deck_with_expectations() -> None:
    proved = _proved()
    missing = ["/".join(law) for law in LAWS if law_class(*law).__module__ not in proved]
    assert not missing, f"{len(missing)} laws without a deck: {', '.join(missing)}"
