"""Claim: --set reaches every number and word of a deck, and says where a path leads nowhere."""

from pathlib import Path
from typing import Any

import pytest

from crashsolve.deck.numbers import SiFloat, as_written
from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.foundation.errors import DeckErrors

TEXT = """\
title: "ball of ${r*1000} mm"
units: {length: mm}
parameters: {r: 1.8 mm, n: 3}
control: {end_time: 1}
curves: {f: {points: [[0, 0], ["${n/3}", 2]]}}
bodies:
  ball: &ball {mass: 1, inertia: [1, 1, 1], velocity: [1, 2, 3]}
  other: *ball
surfaces:
  ball: {type: sphere, body: ball, radius: "${r}"}
  floor: {type: plane}
contacts:
  touch: {a: [ball], b: [floor], normal: {type: penalty, stiffness: 1e6}}
loads:
  push: {type: force, body: ball, force: [0, 0, 1], curve: f}
watch: [rbdout.ball.velocity.z, {channel: rbdout.ball.position.z}]
expect:
  - {channel: rbdout.ball.velocity.z, statistic: final, value: 3, tolerance: 1, unit: m/s, because: golden, source: x}
"""  # noqa: E501


def deck_of(folder: Path, **overrides: str) -> Deck:
    path = folder / "deck.yaml"
    path.write_text(TEXT, "utf-8")
    return read_deck(path, {name.replace("__", "."): text for name, text in overrides.items()})


def value(deck: Deck, path: str) -> Any:
    """What the deck says at a path of Python names."""
    keyword, *steps = path.split(".")
    item: Any = getattr(deck, keyword, None) or deck.entries[keyword][steps.pop(0)].card
    for step in steps:
        item = item[int(step)] if step.isdigit() else getattr(item, step)
    return item


@pytest.mark.parametrize(
    ("name", "text", "path", "expected"),
    [
        ("output.history.interval", "1e-3", "output.history.interval", 1e-3),
        ("output.log.interval", "2 ms", "output.log.interval", 2e-3),
        ("contacts.touch.normal.stiffness", "2", "contacts.touch.normal.stiffness", 2.0),
        ("loads.push.force.3", "${n*2} N", "loads.push.force.2", 6.0),
        ("contacts.touch.speed_floor", "5", "contacts.touch.speed_floor", 5e-3),
        ("contacts.touch.a.1", "floor", "contacts.touch.a.0", "floor"),
        ("bodies.ball.velocity.3", "-7", "bodies.ball.velocity.2", -7e-3),
        ("bodies.ball.velocity.3", "-7 m/s", "bodies.ball.velocity.2", -7.0),
        ("curves.f.points.2.2", "9", "curves.f.points.1.1", 9.0),
        ("loads.push.axes", "body", "loads.push.axes", "body"),
        ("expect.1.value", "4", "expect.0.value", 4.0),
        ("watch.2.statistic", "max", "watch.1.statistic", "max"),
        ("title", "other", "title", "other"),
        ("parameters.n", "4", "parameters", {"r": 1.8e-3, "n": 4.0}),
    ],
)
def test_every_field_can_be_set(
    name: str, text: str, path: str, expected: Any, tmp_path: Path
) -> None:
    assert value(deck_of(tmp_path, **{name: text}), path) == pytest.approx(expected, rel=1e-14)


def test_what_is_anchored_is_set_in_one_location_only(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, **{"bodies.ball.mass": "5", "bodies.ball.velocity.1": "0"})
    assert deck.entries["bodies"]["ball"].card.mass == 5.0
    assert deck.entries["bodies"]["other"].card.mass == 1.0
    assert deck.entries["bodies"]["other"].card.velocity[0] == pytest.approx(1e-3)


def test_units_of_the_deck_can_be_set(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, **{"units.length": "cm"})
    assert deck.entries["bodies"]["ball"].card.velocity == pytest.approx((0.01, 0.02, 0.03))


@pytest.mark.parametrize(
    ("word", "reported"),
    [
        ("contact.touch.a=1", "unknown keyword 'contact'; did you mean 'contacts'? ("),
        ("contacts.tuch.a=1", "contacts: unknown contact 'tuch'; did you mean 'touch'? ("),
        (
            "contacts.touch=1",
            "contacts: which field of the contact?; write contacts.touch.FIELD",
        ),
        ("contacts=1", "contacts: which contact, and which field of it?; write contacts.NAME"),
        ("output=1", "output: which field of it?; write output.FIELD=VALUE"),
        (
            "output.histori.interval=1",
            "output: unknown field 'histori'; did you mean 'history'?",
        ),
        (
            "output.history.intervall=1",
            "output: history: unknown field 'intervall'; did you mean",
        ),
        (
            "output.history.interval=0",
            "output: history.interval: must be at least 1e-15 s, not 0",
        ),
        ("control.end_time.now=1", "there is no field 'now' here: the deck has 1"),
        (
            "bodies.ball.velocity.4=1",
            "'4' is no position of a list of 3; entries count from 1 to 3",
        ),
        ("bodies.ball.velocity.0=1", "'0' is no position of a list of 3"),
        ("bodies.ball.velocity.z=1", "'z' is no position of a list of 3"),
        ("bodies.ball.velocity.²=1", "'²' is no position of a list of 3"),
        (
            "bodies.ball.position.1=1",
            "the deck has no list 'position' here; write it in the deck",
        ),
        (
            "bodies.ball.velocity=[0, 0, 1]",
            "a list or a table cannot be set; write it in the deck, and set its entries, as "
            "bodies.ball.velocity.1=VALUE",
        ),
        ("bodies.ball.mass=-1", "body 'ball': mass: must be greater than 0 kg, not -1"),
        ("bodies.ball.mass=many", "body 'ball': mass: must be a number in kg; 'many' is not a"),
        (
            "contacts.touch.normal.type=herz",
            "contact 'touch': normal: unknown type 'herz'; did you",
        ),
        (
            "contacts.touch.a.1=bal",
            "contact 'touch': a: unknown surface 'bal'; did you mean 'ball'",
        ),
        (
            "watch.1.statistic=max",
            "there is no field 'statistic' here: the deck has 'rbdout.ball",
        ),
        ("watch.3.channel=x", "watch: unknown watch '3'"),
        ("bodies.ball.mass=010", "'010' begins with a zero; write 10"),
        ("include.1=x", "files are read before anything is set; write it in the deck"),
        ("m=1", "unknown parameter 'm'"),
    ],
)
def test_a_path_that_leads_nowhere_is_reported(word: str, reported: str, tmp_path: Path) -> None:
    name, _, text = word.partition("=")
    with pytest.raises(DeckErrors) as caught:
        deck_of(tmp_path, **{name: text})
    assert str(caught.value).startswith(f"--set {word}: error: {reported}")


def test_numbers_in_texts_print_as_written(tmp_path: Path) -> None:
    # 1.8 mm is 0.0018000000000000002 m
    assert 1.8 * 1e-3 * 1000 != 1.8
    assert deck_of(tmp_path).title == "ball of 1.8 mm"
    for number, text in (
        (1.8000000000000003, "1.8"),
        (SiFloat(0.1 + 0.2), "0.3"),
        (-1.2345678901, "-1.2345678901"),
        (1.23456789012345, "1.23456789012345"),
        (1 / 3, "0.3333333333333333"),
        (0.0, "0.0"),
        (3, "3"),
        (10**400, str(10**400)),
    ):
        assert as_written(number) == text
