"""Claims: the composed step that is kept for a deck is the one that would be composed anew, and
every deck has one.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from quick import first_quick

from crashsolve.compiler import program
from crashsolve.compiler.cache import CHOSEN, cache_folder
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors
from crashsolve.model.build import build
from crashsolve.system.compose import compose, composed

DECKS = Path(__file__).parents[2] / "decks"
BALL = DECKS / "tutorial" / "bouncing_ball.yaml"


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv(CHOSEN, str(tmp_path))
    cache_folder.cache_clear()
    yield
    cache_folder.cache_clear()


def test_a_deck_is_composed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    deck = read_deck(BALL)
    model, _ = build(deck)
    first = composed(model, deck.text)
    assert first == compose(model)
    # whoever would compose again finds no composer
    monkeypatch.delattr(program, "Program")
    assert composed(build(deck)[0], deck.text) == first
    with pytest.raises(ImportError):
        composed(build(read_deck(BALL, {"control.integrator": "dormand_prince_5"}))[0], "another")


def test_another_method_is_another_step() -> None:
    texts = []
    for method in ("rattle", "dormand_prince_5", "rattle"):
        deck = read_deck(BALL, {"control.integrator": method})
        model, _ = build(deck)
        # even where the text of the deck would not say it
        texts.append(composed(model, "the same"))
    assert texts[0] == texts[2] != texts[1]


def test_damaged_text_is_composed_anew() -> None:
    deck = read_deck(BALL)
    model, _ = build(deck)
    first = composed(model, deck.text)
    for path in cache_folder().glob("crashsolve_step_*.py"):
        path.write_text("# nothing\n", "utf-8")
    assert composed(model, deck.text) == first


def long_decks() -> list[Path]:
    """Decks that run only with the long tests."""
    paths = sorted((DECKS / "verification").rglob("*.yaml"))
    return [path for path in paths if path.read_text("utf-8").startswith("# long\n")]


@pytest.mark.parametrize("path", long_decks(), ids=lambda path: path.stem)
def test_decks_that_run_rarely_have_a_step(path: Path) -> None:
    """Stages, laws and elements that only they have fit the loops that call them."""
    assert "def advance(" in compose(build(read_deck(path))[0])


def verification_decks() -> list[Path]:
    """Decks that together have all laws, pairs of shapes and elements."""
    return sorted((DECKS / "verification").rglob("*.yaml"))


@pytest.mark.parametrize("method", first_quick(["radau_iia_5", "dormand_prince_8"]))
@pytest.mark.parametrize("path", verification_decks(), ids=lambda path: path.stem)
def test_every_kind_of_method_has_a_step_for_every_law(path: Path, method: str) -> None:
    """Or the deck is refused. Only these methods end steps at events of laws."""
    try:
        model, _ = build(read_deck(path, {"control.integrator": method}))
    except DeckErrors:
        return
    assert "def advance(" in compose(model)
