"""Claim: bounds are reported: of the number of includes, of words put in, of lengths."""

from pathlib import Path

import pytest

from crashsolve.deck.reading import files
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import MAX_ERRORS, DeckErrors
from crashsolve.model.build import build

BODY = 'bodies: {"b<x>": {mass: 1, inertia: [1, 1, 1]}}\n'


def test_files_that_each_include_the_next_twice_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Thirty of them would be a thousand million files; the bound is reported once."""
    monkeypatch.setattr(files, "MAX_FILES", 200)
    first = "include: [{file: a1.yaml, with: {x: l}}, {file: a1.yaml, with: {x: r}}]\n"
    (tmp_path / "a0.yaml").write_text(f"control: {{end_time: 1}}\n{first}")
    for k in range(1, 31):
        name = f"a{k + 1}.yaml"
        both = ", ".join(f'{{file: {name}, with: {{x: "<x>{side}"}}}}' for side in "lr")
        (tmp_path / f"a{k}.yaml").write_text(BODY + (f"include: [{both}]\n" if k < 30 else ""))
    with pytest.raises(DeckErrors) as reported:
        read_deck(tmp_path / "a0.yaml")
    assert str(reported.value).count("more than 200 files") == 1


def test_a_file_is_read_once_however_often_it_is_included(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cost of a deck of N includes is N copies with their words, and no N readings."""
    count, read = 100, []
    plain = files.read_yaml
    monkeypatch.setattr(files, "read_yaml", lambda *of: (read.append(of[0]), plain(*of))[1])
    many = ", ".join(f"{{file: car.yaml, with: {{x: {k}}}}}" for k in range(count))
    (tmp_path / "deck.yaml").write_text(f"control: {{end_time: 1}}\ninclude: [{many}]\n")
    (tmp_path / "car.yaml").write_text(BODY)
    deck = read_deck(tmp_path / "deck.yaml")
    assert [path.name for path in read] == ["deck.yaml", "car.yaml"]
    assert list(deck.entries["bodies"]) == [f"b{k}" for k in range(count)]


def test_a_file_that_cannot_be_read_is_reported_once(tmp_path: Path) -> None:
    many = ", ".join(f"{{file: car.yaml, with: {{x: {k}}}}}" for k in range(3))
    (tmp_path / "deck.yaml").write_text(f"control: {{end_time: 1}}\ninclude: [{many}]\n")
    (tmp_path / "car.yaml").write_text("bodies: {\n")
    with pytest.raises(DeckErrors) as reported:
        read_deck(tmp_path / "deck.yaml")
    assert str(reported.value).count("not valid YAML") == 1


def test_words_that_grow_are_refused(tmp_path: Path) -> None:
    """Each file doubles the word: 2^20 letters after 20 of them."""
    (tmp_path / "a0.yaml").write_text(
        "control: {end_time: 1}\ninclude: [{file: a1.yaml, with: {x: ab}}]\n"
    )
    for k in range(1, 21):
        more = f'include: [{{file: a{k + 1}.yaml, with: {{x: "<x><x>"}}}}]\n' if k < 20 else ""
        (tmp_path / f"a{k}.yaml").write_text(BODY + more)
    with pytest.raises(DeckErrors, match="letters, more than 10000"):
        read_deck(tmp_path / "a0.yaml")


def test_a_file_included_many_times_is_named_once_each(tmp_path: Path) -> None:
    """Its own names are counted on, and not sought from the first each time."""
    many = ", ".join(f"{{file: car.yaml, with: {{x: {k}}}}}" for k in range(300))
    (tmp_path / "deck.yaml").write_text(f"control: {{end_time: 1}}\ninclude: [{many}]\n")
    (tmp_path / "car.yaml").write_text(BODY)
    reader = files.Files([])
    tables = reader.read(tmp_path / "deck.yaml")
    assert len(tables) == 301
    assert (tmp_path / "car.yaml (300)") in tables
    assert reader.paths == [tmp_path / "deck.yaml", tmp_path / "car.yaml"]


@pytest.mark.parametrize(
    "field",
    ["velocity: [0, -1e160, 0]", "velocity: [1e13 km/h, 0, 0]", "angular_velocity: [0, 0, 1e13]"],
)
def test_contradictory_velocities_are_refused(tmp_path: Path, field: str) -> None:
    """They were taken for errors of the steps, which smaller steps would mend."""
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        f"control: {{end_time: 1}}\nbodies: {{b: {{mass: 1, inertia: [1, 1, 1], {field}}}}}\n"
    )
    with pytest.raises(DeckErrors, match="velocity: is more than 1e.12 .*check powers and units"):
        build(read_deck(deck))


def test_long_words_and_many_errors_are_cut(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    bodies = "".join(f"  b{k}: {{mass: {'9' * 300} m}}\n" for k in range(250))
    deck.write_text(f"control: {{end_time: 1}}\nbodies:\n{bodies}")
    with pytest.raises(DeckErrors) as reported:
        read_deck(deck)
    lines = str(reported.value).splitlines()
    # each body lacks its inertia, or has a mass in metres: one message of each kind at least
    assert len(lines) == MAX_ERRORS + 1
    assert lines[-1] == f"error: {len(reported.value.errors) - MAX_ERRORS} more like these"
    assert max(map(len, lines)) < 300
    assert f"'{'9' * 36}... (300 letters) m'" in lines[0]


def test_a_long_number_set_from_outside_is_cut(tmp_path: Path) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text("parameters: {m: 1}\ncontrol: {end_time: 1}\n")
    with pytest.raises(DeckErrors, match=r"--set m=9{34}\.\.\. \(502 letters\): error: "):
        read_deck(deck, {"m": "9" * 500})


@pytest.mark.parametrize("radius", ["1e300", "2e40", "1e38 km"])
def test_lengths_whose_powers_no_machine_holds_are_refused(tmp_path: Path, radius: str) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(
        "control: {end_time: 1}\nbodies: {b: {mass: 1, inertia: [1, 1, 1]}}\n"
        f"surfaces: {{s: {{type: sphere, body: b, radius: {radius}}}}}\n"
    )
    with pytest.raises(DeckErrors, match="radius: is a length of more than"):
        build(read_deck(deck))


@pytest.mark.parametrize(
    "card", ["mass: 1e300, inertia: [1, 1, 1]", "mass: 2e60, inertia: [1, 1, 1]"]
)
def test_masses_whose_powers_no_machine_holds_are_refused(tmp_path: Path, card: str) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(f"control: {{end_time: 1}}\nbodies: {{b: {{{card}}}}}\n")
    with pytest.raises(DeckErrors, match=r"mass: is a mass of more than 1e\+60 kg"):
        build(read_deck(deck))
