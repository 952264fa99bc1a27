"""Claim: numbers outside the range of their kind are reported, and none of the decks here."""

from pathlib import Path

import pytest
from command import crashsolve

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import CrashsolveError
from crashsolve.model.checks.magnitudes import magnitude_table, magnitude_warnings

DECKS = Path(__file__).resolve().parents[2] / "decks"
DECK = """
control: {end_time: 1}
materials: {m: {type: elastic, young: YOUNG, poisson: 0.3, density: DENSITY}}
sections: {s: {type: circle, radius: THICK}}
parts:
  p: {type: beam, section: s, material: m, side: [0, 1, 0],
      mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}}
bodies:
  a: {mass: MASS, primitive: {shape: sphere, radius: RADIUS}, rotation: {axis: [1, 0, 0],
      angle: ANGLE}}
  b: {mass: 1, primitive: {shape: sphere, radius: 0.1}, position: [0.5, 0, 0]}
  c: {mass: 1, primitive: {shape: sphere, radius: 0.1}, position: [X, 0, 0.2]}
joints: {j: {type: revolute, a: a, b: b, at: [AT, 0, 0], axis: [0, 0, 1]}}
springs: {r: {type: rotation_stop, joint: j, stiffness: 1, lower: -1, upper: UPPER}}
"""
RIGHT = {
    "YOUNG": "210e9",
    "DENSITY": "7850",
    "MASS": "1",
    "RADIUS": "0.1",
    "ANGLE": "1.5",
    "X": "0.3",
    "THICK": "0.01",
    "AT": "0.25",
    "UPPER": "2",
}


def warnings(folder: Path, **changed: str) -> list[str]:
    text = DECK
    for word, value in (RIGHT | changed).items():
        text = text.replace(word, value)
    (folder / "deck.yaml").write_text(text, "utf-8")
    deck = read_deck(folder / "deck.yaml", {})
    return magnitude_warnings(deck.entries, False)


@pytest.mark.parametrize(
    ("word", "value", "says"),
    [
        # GPa and MPa, and 210e9 GPa
        ("YOUNG", "210", "wave speed of 0.1636"),
        ("YOUNG", "210e3", "wave speed of 5.172"),
        ("YOUNG", "210e15", "that of no material"),
        ("DENSITY", "7.85", "was the density in g/cm^3?"),
        ("DENSITY", "7.85e-9", "was the density in t/mm^3?"),
        ("DENSITY", "7.85e-6", "was the density in kg/mm^3?"),
        ("DENSITY", "7.85e6", "beyond the density of any material"),
        ("MASS", "1e-6", "the density of no body"),
        ("MASS", "1e6", "the density of no body"),
        ("RADIUS", "100", "the density of no body"),
        ("RADIUS", "1e-4", "the density of no body"),
        ("ANGLE", "90", "bodies.a.rotation.angle: 90 rad is 14.3 revolutions"),
        ("ANGLE", "-22.5", "were degrees meant? Write '-22.5 deg'"),
        # half a turn and more, in steps of a half
        ("ANGLE", "5", "bodies.a.rotation.angle: 5 rad is 0.796 revolutions"),
        ("UPPER", "45", "springs.r.upper: 45 rad is 7.16 revolutions"),
        ("X", "300", "bodies.c.position: 299.5 m from all other bodies"),
        ("AT", "250", "joints.j.at: 249.5 m from all other bodies"),
        ("THICK", "10", "sections.s.radius: 10 m for the beam 'p' of 1 m"),
    ],
)
def test_a_wrong_unit_is_reported(tmp_path: Path, word: str, value: str, says: str) -> None:
    texts = warnings(tmp_path, **{word: value})
    assert any(says in text for text in texts), texts


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("YOUNG", "2e6"),  # rubber
        ("YOUNG", "1.05e12"),  # diamond
        ("DENSITY", "19300"),
        ("MASS", "50"),  # lead and heavier
        ("ANGLE", "'90 deg'"),
        ("ANGLE", "'720 deg'"),
        ("ANGLE", "3"),
        ("UPPER", "100"),  # none
        ("UPPER", "'45 deg'"),
        ("AT", "3"),
        ("THICK", "0.4"),
        ("X", "5"),
    ],
)
def test_an_unusual_number_is_not(tmp_path: Path, word: str, value: str) -> None:
    assert warnings(tmp_path, **{word: value}) == []


@pytest.mark.long
def test_no_deck_of_the_repository_is_reported() -> None:
    tried = 0
    for path in sorted(DECKS.rglob("*.yaml")):
        try:
            deck = read_deck(path, {}, False)
        except CrashsolveError:
            # a piece that others include, or a plan
            continue
        tried += 1
        is_static = deck.control.solution != "transient"
        assert magnitude_warnings(deck.entries, is_static) == [], path
    assert tried > 200


def test_check_lists_the_ends_of_every_kind(tmp_path: Path) -> None:
    warnings(tmp_path, YOUNG="210")
    done = crashsolve("check", tmp_path / "deck.yaml")
    assert done.returncode == 0, done.stdout
    assert "warning: materials.m: young = 210 Pa" in done.stdout
    assert "lengths: 0.01 m (sections.s.radius) to 1 m (parts.p.mesh.to)" in done.stdout
    assert "wave speeds: 0.1636 m/s (m)" in done.stdout


def test_limits_of_a_range_may_be_beyond_all_motion() -> None:
    deck = read_deck(DECKS / "verification/joints/rotation_driver.yaml", {}, False)
    assert any(line.startswith("angles:") for line in magnitude_table(deck.entries))


def test_round_off_is_no_length(tmp_path: Path) -> None:
    text = DECK
    for word, value in (RIGHT | {"X": "'${0.1 + 0.2 - 0.3}'"}).items():
        text = text.replace(word, value)
    (tmp_path / "deck.yaml").write_text(text, "utf-8")
    (lengths,) = (
        line
        for line in magnitude_table(read_deck(tmp_path / "deck.yaml", {}).entries)
        if line.startswith("lengths")
    )
    assert lengths.startswith("lengths: 0.01 m")
