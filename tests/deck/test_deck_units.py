"""Claim: a unit in a deck means what NIST SP 811 says, and a doubtful one is refused."""

import math
from pathlib import Path

import pytest

from crashsolve.channels.units import (
    BASES,
    UnitError,
    default_factor,
    describe,
    parse_unit,
    split_quantity,
    to_si,
)
from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckErrors

# values of NIST SP 811 (2008), appendix B.8, and of the SI brochure
KNOWN = [
    ("54 km/h", "m/s", 15.0),
    ("12 mm", "m", 0.012),
    ("-3 deg", "rad", -math.pi / 60.0),
    ("3 kN/mm", "N/m", 3e6),
    ("2 N s/m", "kg/s", 2.0),
    ("1 kg m^2", "kg m^2", 1.0),
    ("1 N/mm^1.5", "N/m^1.5", 1000.0**1.5),
    ("1 N/mm**1.5", "N/m^1.5", 1000.0**1.5),
    ("180 deg/s", "rad/s", math.pi),
    ("60 rpm", "rad/s", 2.0 * math.pi),
    ("5 g", "kg", 0.005),
    ("1 g0", "m/s^2", 9.80665),
    ("2 t", "kg", 2000.0),
    ("1 lb", "kg", 0.45359237),
    ("1 lbf", "N", 4.4482216152605),
    ("1 in", "m", 0.0254),
    ("1 ft", "m", 0.3048),
    ("1 mph", "m/s", 0.44704),
    ("1 bar", "Pa", 1e5),
    ("3 MPa", "N/m^2", 3e6),
    ("1 GPa", "Pa", 1e9),
    ("15 tf", "N", 147099.75),
    ("2 kgf", "N", 19.6133),
    ("5 %", "1", 0.05),
    ("7", "m", 7.0),
    ("1.5e3 N m/rad", "N m/rad", 1500.0),
    ("1 N m/deg", "N m/rad", 180.0 / math.pi),
    ("5 J/(kg m)", "m/s^2", 5.0),
    ("4 us", "s", 4e-6),
    ("4 µs", "s", 4e-6),
    ("1 h", "s", 3600.0),
    (".5 m", "m", 0.5),
    ("2 N·m", "J", 2.0),
]


@pytest.mark.parametrize(("text", "wanted", "value"), KNOWN)
def test_a_quantity_is_converted_to_si(text: str, wanted: str, value: float) -> None:
    assert to_si(text, wanted) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "wanted", "reason"),
    [
        ("3 kg", "m", "'3 kg' is in kg"),
        ("3 g", "m/s^2", "'3 g' is in kg (the gram; standard gravity is 'g0')"),
        ("5 Hz", "rad/s", "'5 Hz' is in 1/s"),
        ("5 N m", "N m/rad", "'5 N m' is in J"),
        ("1 N/m s", "N/m", "'N/m s' can be read in two ways; use brackets: 'J/(kg m)'"),
        ("3 furlong", "m", "unknown unit 'furlong'"),
        ("3 kt", "kg", "unknown unit 'kt'"),
        ("3 m2", "m^2", "unknown unit 'm2'; a power is written 'm^2'"),
        ("3 m^", "m", "the unit 'm^' is not complete"),
        ("3 m^x", "m", "the unit 'm^x' has the power 'x', not a number"),
        ("3 m^10", "m", "the unit 'm^10' has a power beyond 9"),
        ("3 (m", "m", "the unit '(m' is not complete"),
        ("3 m)", "m", "cannot read the unit 'm)'"),
        ("3 m;", "m", "cannot read the unit 'm;'"),
        ("three m", "m", "'three m' is not a number with a unit"),
        ("", "m", "'' is not a number with a unit"),
        ("1e999 m", "m", "'1e999 m' is too large"),
        ("nan m", "m", "'nan m' is not a number with a unit"),
        ("3 " + "m " * 50, "m", "a unit of more than 80 letters"),
    ],
)
def test_a_doubtful_quantity_is_refused(text: str, wanted: str, reason: str) -> None:
    with pytest.raises(UnitError) as caught:
        to_si(text, wanted)
    assert str(caught.value) == reason


@pytest.mark.parametrize(
    ("length", "mass", "time", "force"),
    [("mm", "t", "s", 1.0), ("mm", "kg", "ms", 1e3), ("m", "t", "s", 1e3), ("m", "kg", "s", 1.0)],
)
def test_default_units_carry_over_to_force(length: str, mass: str, time: str, force: float) -> None:
    names = dict(zip(BASES, (length, mass, time, "rad"), strict=True))
    bases = {base: parse_unit(name) for base, name in names.items()}
    assert default_factor(parse_unit("N"), bases) == pytest.approx(force, rel=1e-14)
    assert to_si("2", "N", bases) == pytest.approx(2.0 * force, rel=1e-14)


def test_a_number_and_its_unit_are_parted() -> None:
    assert split_quantity(" 54  km/h ") == (54.0, "km/h")
    assert split_quantity("3") == (3.0, "")
    assert split_quantity("3mm") == (3.0, "mm")


@pytest.mark.parametrize("name", ["N", "N/m", "kg m^2", "m/s", "1/s", "1", "rad/s", "m^1.5/s"])
def test_a_dimension_is_described_by_a_unit_that_has_it(name: str) -> None:
    assert parse_unit(describe(parse_unit(name))).exponents == parse_unit(name).exponents


DECK = """\
units: {length: mm, time: ms}
parameters: {speed: 5 m/s, gap: 3, share: 0.5, tilt: 30 deg, depth: 20 mm, half: "${depth*share}"}
control: {end_time: 1}
bodies:
  a: {mass: 1, inertia: [1, 1, 1], position: ["EXPRESSION", 0, 0]}
"""


@pytest.mark.parametrize(
    ("expression", "metres"),
    [
        # bare numbers are pure where units fit
        ("half", 0.01),
        ("half + depth/2", 0.02),
        ("sqrt(depth*half)*share", 0.5 * math.sqrt(2e-4)),
        ("depth**1.5/half**0.5", 0.02**1.5 / 0.01**0.5),
        # and in units of the file where those of the others cancel
        ("gap*sin(tilt)", 1.5e-3),
        ("gap*depth/half", 6e-3),
        # the rest is refused
        ("depth + gap", None),
        ("max(gap, half)", None),
        ("depth*half", None),
        ("depth/speed", None),
        ("sqrt(depth)", None),
        ("gap*speed", None),
        ("depth**gap", None),
    ],
)
def test_bare_numbers_beside_units_are_understood_or_refused(
    expression: str, metres: float | None, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    deck.write_text(DECK.replace("EXPRESSION", f"${{{expression}}}"), "utf-8")
    if metres is None:
        with pytest.raises(DeckErrors, match="give the unit of every parameter that has one"):
            read_deck(deck)
        return
    position = read_deck(deck).entries["bodies"]["a"].card.position[0]
    assert position == pytest.approx(metres, rel=1e-14)


@pytest.mark.parametrize(
    ("expression", "radians"),
    [("atan2(1, 2)", math.atan2(1, 2)), ("2*asin(0.5)", math.pi / 3), ("45 + asin(0.5)", None)],
)
def test_functions_give_radians_whatever_the_units(
    expression: str, radians: float | None, tmp_path: Path
) -> None:
    deck = tmp_path / "deck.yaml"
    text = DECK.replace("time: ms", "angle: deg").replace('"EXPRESSION"', "0")
    turned = text.replace(
        "mass: 1", f'mass: 1, rotation: {{axis: [0, 0, 1], angle: "${{{expression}}}"}}'
    )
    deck.write_text(turned, "utf-8")
    if radians is None:
        with pytest.raises(DeckErrors, match="give the unit of every parameter that has one"):
            read_deck(deck)
        return
    angle = read_deck(deck).entries["bodies"]["a"].card.rotation.angle
    assert angle == pytest.approx(radians, rel=1e-14)


MAIN = """include: [part.yaml]
control: {end_time: 1}
parameters: {n: 2, gap: 3, depth: "20 mm", pure: "4 1"}
"""
PART = """units: {length: mm}
parameters: {own: 5, doubled: "${2*gap}"}
bodies: {a: {mass: "${n}", inertia: [1, 1, 1], position: ["EXPRESSION", 0, 0]}}
"""


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("expression", "metres"),
    [
        # which of both files has millimetres makes no difference to what is refused
        ("gap", None),
        ("doubled", None),
        ("gap*sin(1)", None),
        ("gap + depth", None),
        ("own*n", None),
        # pure where units fit, or where it is stated
        ("n*depth", 0.04),
        ("depth/gap", 0.02 / 3),
        ("own*pure", 0.02),
        ("0*gap", 0.0),
    ],
)
def test_a_bare_parameter_of_a_file_with_other_units_is_pure_or_refused(
    expression: str, metres: float | None, turned: bool, tmp_path: Path
) -> None:
    units, part = "units: {length: mm}\n", PART.replace("EXPRESSION", f"${{{expression}}}")
    deck, file = tmp_path / "deck.yaml", tmp_path / "part.yaml"
    deck.write_text(units * turned + MAIN, "utf-8")
    file.write_text(part.removeprefix(units) if turned else part, "utf-8")
    if metres is None:
        with pytest.raises(DeckErrors, match="which are not those of this file; give its unit"):
            read_deck(deck)
        return
    card = read_deck(deck).entries["bodies"]["a"].card
    own = 1000.0 if turned and "own" in expression else 1.0
    assert card.position[0] == pytest.approx(own * metres, rel=1e-14)
    # a mass is in kg in both
    assert card.mass == 2.0
