"""Claim: a deck is read as written, whatever its files, parameters and units."""

from pathlib import Path

import pytest

from crashsolve.deck.expect import Expect
from crashsolve.deck.read import Deck, read_deck
from crashsolve.foundation.errors import DeckErrors

TRAIN = """\
title: two wagons
parameters: {speed: 54 km/h, half: "${speed/2}", count: 3, gap: 0.5}
control: {end_time: "${count/10} s"}
curves:
  crush: {points: [[0, 0], ["100 mm", "1 MN"]], extrapolate: linear}
bodies:
  front:
    mass: 60 t
    inertia: [1, 2, 2]
    velocity: ["${speed}", 0, 0]
    rotation: {euler: [0, 0, 90 deg], sequence: xyz}
  rear: {mass: 30 t, inertia: [1, 1, 1], velocity: ["${-half}", "${gap*2}", 0]}
springs:
  coupler: {type: linear, a: front, b: rear, stiffness: 3 kN/mm}
expect:
  - {channel: x, statistic: max, value: 12 mm, tolerance: 1 %, because: exact, source: theory}
"""


def deck_of(folder: Path, text: str, **overrides: str) -> Deck:
    path = folder / "deck.yaml"
    path.write_text(text, encoding="utf-8")
    return read_deck(path, overrides)


def messages(folder: Path, text: str, **overrides: str) -> list[str]:
    with pytest.raises(DeckErrors) as caught:
        deck_of(folder, text, **overrides)
    return str(caught.value).replace(f"{folder}/", "").splitlines()


def test_a_deck_becomes_cards_in_si(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, TRAIN)
    front, rear = (entry.card for entry in deck.entries["bodies"].values())
    assert deck.title == "two wagons"
    assert front.mass == 60e3
    assert front.velocity == (15.0, 0.0, 0.0)
    assert rear.velocity == (-7.5, 1.0, 0.0)
    assert deck.control.end_time == pytest.approx(0.3)
    assert deck.parameters == {"speed": 15.0, "half": 7.5, "count": 3.0, "gap": 0.5}
    spring = deck.entries["springs"]["coupler"]
    assert (spring.type, spring.module_name) == ("linear", "crashsolve.springs.linear")
    assert spring.where[1:] == (14, 3)
    assert deck.entries["joints"] == {}


def test_the_resolved_deck_reads_back_as_itself(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, TRAIN)
    again = deck_of(tmp_path, deck.text)
    assert again.text == deck.text
    assert again.expectations()[0] | {"line": 0} == deck.expectations()[0] | {"line": 0}
    for keyword, entries in deck.entries.items():
        cards = {name: entry.card for name, entry in again.entries[keyword].items()}
        assert cards == {name: entry.card for name, entry in entries.items()}


@pytest.mark.parametrize(
    "title", ["1e5", "true", "a: b", "x\u2028y\x85\x7f", "'\"\\", "<<", "é", "010"]
)
def test_any_title_reads_back_as_itself(title: str, tmp_path: Path) -> None:
    import json

    escaped = json.dumps(title).replace("\x7f", "\\x7f")
    deck = deck_of(tmp_path, f"title: {escaped}\ncontrol: {{end_time: 1}}\n")
    assert deck.title == title
    assert deck_of(tmp_path, deck.text).title == title


def test_expectations_are_in_si_with_their_lines(tmp_path: Path) -> None:
    assert deck_of(tmp_path, TRAIN).expectations() == [
        {
            "channel": "x",
            "statistic": "max",
            "value": 0.012,
            "tolerance": 0.01,
            "relative": True,
            "unit": "m",
            "because": "exact",
            "source": "theory",
            "line": 16,
        }
    ]


@pytest.mark.parametrize(
    ("text", "value", "tolerance", "unit"),
    [
        ("value: 12 mm, tolerance: 0.1", 0.012, 1e-4, "m"),
        ("value: 12, tolerance: 1 mm, unit: mm", 0.012, 1e-3, "m"),
        ("value: 12, tolerance: 1 mm", 12.0, 1e-3, "m"),
        ("value: 12, tolerance: 1", 12.0, 1.0, None),
        ("value: -3, tolerance: 0", -3.0, 0.0, None),
        ("value: 5 %, tolerance: 0.1", 0.05, 0.001, "1"),
        ("value: 5, tolerance: 0.1, unit: '%'", 0.05, 0.001, "1"),
        ("value: 5 %, tolerance: 0.1 %, relative: false", 0.05, 0.001, "1"),
    ],
)
def test_a_bare_tolerance_is_in_the_unit_of_the_value(
    text: str, value: float, tolerance: float, unit: str | None, tmp_path: Path
) -> None:
    card = expecting(tmp_path, text)
    assert (card.value, card.tolerance) == pytest.approx((value, tolerance))
    assert (card.unit, card.relative) == (unit, False)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("value: 12 mm, tolerance: 2 %", "m"),
        ("value: 12, tolerance: 2 %", None),
        ("value: 12 mm, tolerance: 0.02, relative: true", "m"),
        ("value: 5, tolerance: 2 %, unit: '%', relative: true", "1"),
        ("value: 5, tolerance: 0.02, unit: '%', relative: true", "1"),
    ],
)
def test_a_relative_tolerance_is_a_share_whatever_the_unit_of_the_value(
    text: str, unit: str | None, tmp_path: Path
) -> None:
    card = expecting(tmp_path, text)
    assert card.tolerance == pytest.approx(0.02)
    assert (card.unit, card.relative) == (unit, True)


def expecting(folder: Path, text: str) -> Expect:
    """The card of a deck's one expectation."""
    start = "control: {end_time: 1}\nexpect:\n"
    line = f"  - {{channel: x, statistic: final, {text}, because: golden, source: run}}\n"
    return deck_of(folder, start + line).expect[0]
