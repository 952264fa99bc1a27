"""Claim: scalars follow YAML 1.2, and every key and value knows its location."""

import pytest

from crashsolve.deck.source import Position, Table, locate, parse_yaml
from crashsolve.foundation.errors import DeckError


def parsed(text: str) -> Table:
    diagnostics: list[DeckError] = []
    table = parse_yaml(text, "deck.yaml", diagnostics)
    assert not diagnostics, str(diagnostics[0])
    assert table is not None
    return table


# YAML 1.2.2, section 10.2.1, and where YAML 1.1 would read something else
@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e5", 1e5),
        ("1E+5", 1e5),
        ("-.5", -0.5),
        ("1.", 1.0),
        ("12", 12),
        ("+12", 12),
        ("-0", 0),
        ("0x1F", 31),
        ("0o17", 15),
        ("on", "on"),
        ("off", "off"),
        ("yes", "yes"),
        ("NO", "NO"),
        ("true", True),
        ("False", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("1_000", "1_000"),
        ("12:30:45", "12:30:45"),
        ("2024-01-01", "2024-01-01"),
        ("0b11", "0b11"),
        (".", "."),
        ("1e", "1e"),
        ("'010'", "010"),
        ('"1e5"', "1e5"),
        ("!!str 12", "12"),
        ("!!float 12", 12),
        ("54 km/h", "54 km/h"),
        ("nan", "nan"),
    ],
)
def test_scalar(text: str, value: object) -> None:
    number = parsed(f"key: {text}")["key"]
    assert number == value
    assert type(number) is type(value)


def test_anchors_and_merges() -> None:
    table = parsed("base: &base {a: 1, b: 2}\nfirst: {<<: *base, b: 3}\nsecond: [*base]\n")
    assert table["first"] == {"a": 1, "b": 3}
    assert table["second"] == [{"a": 1, "b": 2}]
    assert parsed("a: &a {x: 1}\nb: &b {y: 2}\nc: {<<: [*a, *b]}")["c"] == {"x": 1, "y": 2}


DECK = """\
title: é
bodies:
  wagon:
    mass: 3
    at: [1, 2,
         3]
"""


@pytest.mark.parametrize(
    ("path", "key", "line", "column"),
    [
        (("title",), False, 1, 8),
        (("title",), True, 1, 1),
        (("bodies", "wagon"), False, 3, 3),
        (("bodies", "wagon", "mass"), True, 4, 5),
        (("bodies", "wagon", "mass"), False, 4, 11),
        (("bodies", "wagon", "at", 2), False, 6, 10),
        (("bodies", "wagon", "at", 7), False, 5, 5),
        (("bodies", "wagon", "colour"), True, 3, 3),
        (("bodies", 3), True, 2, 1),
    ],
)
def test_place(path: tuple[str | int, ...], key: bool, line: int, column: int) -> None:
    start = Position("deck.yaml", 1, 1)
    assert locate(start, parsed(DECK), path, key) == ("deck.yaml", line, column)


def test_several_errors_of_one_file_are_found() -> None:
    diagnostics: list[DeckError] = []
    parse_yaml("a: 010\na: .inf\n3: x\nb: !x y\n", "deck.yaml", diagnostics)
    assert [(error.line, error.column) for error in diagnostics] == [
        (1, 4),
        (2, 4),
        (2, 1),
        (3, 1),
        (4, 4),
    ]
