"""Claim: each wrong deck is refused with exactly the messages that its first lines expect.

The decks of `wrong_types` are read with a package of toy families, as their messages list all
types of a family, and no test should change when a law is added.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from crashsolve.deck import laws
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors

HERE = Path(__file__).parent
MARK = "# expect: "


def decks(folder: str) -> list[str]:
    return sorted(path.name for path in (HERE / folder).glob("*.yaml"))


def expected(name: str) -> list[str]:
    lines = Path(name).read_text("utf-8").splitlines()
    return [line.removeprefix(MARK) for line in lines if line.startswith(MARK)]


def messages(name: str) -> list[str]:
    with pytest.raises(DeckErrors) as caught:
        read_deck(name)
    assert caught.value.exit_code == 2
    return str(caught.value).splitlines()


@pytest.fixture
def toy_families(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.syspath_prepend(str(HERE))
    monkeypatch.setattr(laws, "PACKAGE", "toycrash")
    laws.types_in.cache_clear()
    yield
    laws.types_in.cache_clear()


@pytest.mark.parametrize("name", decks("wrong"))
def test_a_wrong_deck_is_refused_with_its_message(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(HERE / "wrong")
    assert messages(name) == expected(name)


@pytest.mark.parametrize("name", decks("wrong_types"))
def test_a_wrong_type_is_refused_with_its_message(
    name: str, monkeypatch: pytest.MonkeyPatch, toy_families: None
) -> None:
    monkeypatch.chdir(HERE / "wrong_types")
    assert messages(name) == expected(name)


def test_only_the_modules_a_deck_uses_are_imported(tmp_path: Path, toy_families: None) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        "control: {end_time: 1}\n"
        "bodies:\n  ball: {mass: 1, inertia: [1, 1, 1]}\n"
        "springs:\n  rope: {type: linear, b: ball, stiffness: 1}\n"
    )
    assert read_deck(deck).entries["springs"]["rope"].module_name == "toycrash.springs.linear"
    assert "toycrash.springs.broken" not in sys.modules
    assert "geometry" not in laws.types_in("springs")


def test_there_are_sixty_wrong_decks_and_more() -> None:
    assert len(decks("wrong")) + len(decks("wrong_types")) >= 60


def test_bytes_that_are_not_text_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("deck.yaml").write_bytes(b"title: ok\ncontrol: \xff\n")
    assert messages("deck.yaml") == [
        "deck.yaml:2: error: this is not UTF-8 text; save the file as UTF-8"
    ]


@pytest.mark.parametrize(
    ("name", "reason"), [("nowhere.yaml", "No such file or directory"), (".", "Is a directory")]
)
def test_a_file_that_cannot_be_read_is_refused(
    name: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert messages(name) == [f"{name}: error: the file cannot be read: {reason}"]
