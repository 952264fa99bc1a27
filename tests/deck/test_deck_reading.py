"""Claim: a deck is read as written, whatever its files, parameters and units."""

from pathlib import Path

import pytest

from crashsolve.deck.reading.deck import Deck, read_deck
from crashsolve.deck.run_cards.expect import Expect
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


@pytest.mark.parametrize("window", ["[0.1, 0.3]", "[100 ms, 300 ms]"])
def test_a_time_window_is_in_seconds(window: str, tmp_path: Path) -> None:
    start = "control: {end_time: 1}\nexpect:\n"
    text = f"channel: x, statistic: max, during: {window}, value: 1, tolerance: 1"
    line = f"  - {{{text}, because: golden, source: run}}\n"
    (entry,) = deck_of(tmp_path, start + line).expectations()
    assert entry["during"] == pytest.approx([0.1, 0.3])


def expecting(folder: Path, text: str) -> Expect:
    """The card of a deck's one expectation."""
    start = "control: {end_time: 1}\nexpect:\n"
    line = f"  - {{channel: x, statistic: final, {text}, because: golden, source: run}}\n"
    return deck_of(folder, start + line).expect[0]


def test_an_override_replaces_a_parameter(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, TRAIN, speed="36 km/h", count="5")
    assert deck.entries["bodies"]["front"].card.velocity == (10.0, 0.0, 0.0)
    assert deck.parameters["half"] == 5.0
    # what follows from others, and what does no longer
    assert deck.derived == ["half"]
    assert deck_of(tmp_path, TRAIN, half="3 m/s").derived == []
    assert deck.with_units == {"speed": "36 km/h"}
    assert deck.control.end_time == 0.5


KIND = "must be a number, alone or with a unit"


@pytest.mark.parametrize(
    ("word", "reported"),
    [
        (
            "sped=3",
            "unknown parameter 'sped'; did you mean 'speed'? (parameters: speed, half, count, gap)",
        ),
        (
            "speed=30",
            "the deck has '54 km/h' here, and this is a number without unit; give a number with "
            "a unit, such as '30 km/h' or '30 m/s'",
        ),
        (
            "speed=30 km",
            "the deck has '54 km/h' here, and this is a number in m; give a number with a "
            "unit, such as '30 km/h' or '30 m/s'",
        ),
        (
            "speed=${count}",
            "the deck has '54 km/h' here, in m/s, and this is without unit; give a number in m/s",
        ),
        (
            "half=3",
            "the deck has '${speed/2}' here, in m/s, and this is without unit; give a number in "
            "m/s, or what it is computed from",
        ),
        ("count=3 m", "the deck has 3 here; give a number without unit"),
        ("count=", f"{KIND}; this is empty"),
        ("count=many", f"{KIND}; 'many' is not a number with a unit"),
        ("count=30kmh", f"{KIND}; unknown unit 'kmh'; did you mean 'km/h'?"),
        ("count=010", "'010' begins with a zero; write 10, or put it in quotes"),
    ],
)
def test_a_wrong_override_is_refused(word: str, reported: str, tmp_path: Path) -> None:
    name, _, text = word.partition("=")
    assert messages(tmp_path, TRAIN, **{name: text})[0] == f"--set {word}: error: {reported}"


def test_an_override_sets_a_field_of_control(tmp_path: Path) -> None:
    text = "units: {time: ms}\ncontrol: {end_time: 20, step: 1}\n"
    for given, expected in (("0.5", 5e-4), ("2e-4 s", 2e-4), ("auto", "auto")):
        overrides = {"control.step": given, "control.step_max": "0.1 s"}
        control = deck_of(tmp_path, text, **overrides).control
        assert (control.step, control.step_max, control.end_time) == (expected, 0.1, 0.02)
    assert deck_of(tmp_path, "title: none", **{"control.end_time": "3"}).control.end_time == 3.0


def test_a_wrong_field_of_control_is_refused(tmp_path: Path) -> None:
    text = "control: {end_time: 1}\n"
    (message,) = messages(tmp_path, text, **{"control.step": "-1"})
    assert "control: step" in message
    (message,) = messages(tmp_path, text, **{"control.stp": "1"})
    start = "--set control.stp=1: error: control: unknown field 'stp'; did you mean 'step'?"
    assert message.startswith(start)


ROD = """control: {end_time: 1}
materials: {m: {type: elastic, young: 1, poisson: 0, density: 1}}
sections: {s: {type: circle, radius: 1}}
parts:
  rod: &rod
    {type: beam, section: s, material: m,
     mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}}
  other: *rod
"""


def test_an_override_sets_a_field_of_one_part(tmp_path: Path) -> None:
    parts = deck_of(tmp_path, ROD, **{"parts.rod.mesh.division": "3"}).entries["parts"]
    assert [parts[name].card.mesh.count for name in ("rod", "other")] == [6, 2]


def test_a_wrong_field_of_a_part_is_refused(tmp_path: Path) -> None:
    for name, message in (
        ("parts.rid.mesh.division", "unknown part 'rid'; did you mean 'rod'?"),
        ("parts.rod", "which field of the part?"),
        ("parts.rod.mesh.divsion", "unknown field 'divsion'; did you mean 'division'?"),
    ):
        assert message in messages(tmp_path, ROD, **{name: "2"})[0]


def test_an_override_may_be_an_expression(tmp_path: Path) -> None:
    assert deck_of(tmp_path, TRAIN, half="${speed/5}").parameters["half"] == 3.0


def test_units_of_a_file_are_those_of_its_bare_numbers_alone(tmp_path: Path) -> None:
    (tmp_path / "rear.yaml").write_text(
        "units: {length: mm, mass: t, angle: deg}\n"
        "parameters: {own: 3}\n"
        "bodies:\n"
        "  rear:\n"
        "    mass: 30\n"
        "    inertia: [1, 1, 1]\n"
        '    position: [1000, "${gap}", "${own}"]\n'
        "    angular_velocity: [180, 0, 0]\n"
    )
    deck = deck_of(
        tmp_path,
        "include: [rear.yaml]\ncontrol: {end_time: 1}\nparameters: {gap: 2 m}\n"
        "bodies:\n  front: {mass: 30, inertia: [1, 1, 1]}\n",
    )
    rear = deck.entries["bodies"]["rear"].card
    assert deck.entries["bodies"]["front"].card.mass == 30.0
    assert rear.mass == 30e3
    assert rear.inertia == pytest.approx((1e-3, 1e-3, 1e-3))
    # a parameter with a unit is in SI, one without is a bare number of its file
    assert rear.position == pytest.approx((1.0, 2.0, 0.003))
    assert rear.angular_velocity == pytest.approx((3.141592653589793, 0.0, 0.0))


def test_files_are_included_beside_the_file_that_names_them(tmp_path: Path) -> None:
    library = tmp_path / "library"
    library.mkdir()
    (library / "force.csv").write_text("0, 0\n1, 2\n")
    (library / "curves.yaml").write_text("curves:\n  f: {type: file, file: force.csv}\n")
    (library / "all.yaml").write_text("include: [curves.yaml]\nparameters: {end: 2 s}\n")
    deck = deck_of(tmp_path, 'include: [library/all.yaml]\ncontrol: {end_time: "${end}"}\n')
    assert [path.name for path in deck.files] == ["deck.yaml", "all.yaml", "curves.yaml"]
    assert deck.control.end_time == 2.0
    assert list(deck.entries["curves"]) == ["f"]
    assert deck_of(tmp_path, deck.text).entries["curves"]["f"].card.file.endswith("force.csv")


def test_a_name_in_two_files_is_refused(tmp_path: Path) -> None:
    body = "bodies:\n  wagon: {mass: 1, inertia: [1, 1, 1]}\n"
    (tmp_path / "a.yaml").write_text(f"parameters: {{v: 1}}\n{body}")
    (tmp_path / "b.yaml").write_text(f"control: {{end_time: 1}}\nparameters: {{v: 1}}\n{body}")
    start = "include: [a.yaml, b.yaml]\ncontrol: {end_time: 1}\n"
    assert messages(tmp_path, start) == [
        "b.yaml:1:1: error: control: is given twice; first in deck.yaml:2",
        "b.yaml:2:14: error: parameter 'v': is given twice; first in a.yaml:1",
        "b.yaml:4:3: error: body 'wagon': is given twice; first in a.yaml:3",
    ]


def test_circles_and_repeats_of_includes_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("include: [b.yaml]\n")
    (tmp_path / "b.yaml").write_text("include: [deck.yaml]\n")
    assert messages(tmp_path, "include: [a.yaml, ./a.yaml]\ncontrol: {end_time: 1}\n") == [
        "deck.yaml:1:19: error: include: the file is included twice",
        "b.yaml:1:11: error: include: the file includes itself "
        "(deck.yaml -> a.yaml -> b.yaml -> deck.yaml)",
    ]


CAR = """\
parameters: {bogie_<car>: "${<mass>/6}"}
bodies:
  <car>_frame: {mass: "${bogie_<car>}", inertia: [1, 1, 1], position: [<x>, 0, 0]}
springs:
  <car>_pivot: {type: linear, b: <car>_frame, stiffness: 1}
expect:
  - channel: rbdout.<car>_frame.position.x
    statistic: max
    value: <x>
    tolerance: 1
    because: exact
    source: <car>
"""
TWO_CARS = """\
include:
  - {file: car.yaml, with: {car: front, mass: m_1, x: 5}}
  - {file: car.yaml, with: {car: rear, mass: m_2, x: -3 mm}}
control: {end_time: 1}
parameters: {m_1: 6, m_2: 12 t}
"""


def test_a_file_is_included_many_times_with_other_words(tmp_path: Path) -> None:
    (tmp_path / "car.yaml").write_text(CAR)
    deck = deck_of(tmp_path, TWO_CARS)
    bodies = {name: entry.card for name, entry in deck.entries["bodies"].items()}
    assert {name: card.mass for name, card in bodies.items()} == {
        "front_frame": 1.0,
        "rear_frame": 2e3,
    }
    assert [card.position[0] for card in bodies.values()] == [5.0, -3e-3]
    assert deck.entries["springs"]["rear_pivot"].card.b == "rear_frame"
    assert [card.channel for card in deck.expect] == [
        "rbdout.front_frame.position.x",
        "rbdout.rear_frame.position.x",
    ]
    assert [path.name for path in deck.files] == ["deck.yaml", "car.yaml"]
    # written out it is one file without words, and --set reaches all of it
    again = deck_of(tmp_path, deck.text)
    assert again.entries["bodies"]["rear_frame"].card.mass == 2e3
    set_to = deck_of(tmp_path, TWO_CARS, **{"bodies.rear_frame.mass": "7", "m_1": "12"})
    assert set_to.entries["bodies"]["rear_frame"].card.mass == 7.0
    assert set_to.entries["bodies"]["front_frame"].card.mass == 2.0


@pytest.mark.parametrize(
    ("before", "after", "reported"),
    [
        ("car: rear", "car: front", "car.yaml:1:14: error: parameter 'bogie_front'"),
        (", x: 5", "", "car.yaml:3:72: error: include: the word <x> is not given"),
        ("x: 5", "x: 5, y: 5", "car.yaml: error: include: nothing in the file has the word <y>"),
        ("x: 5", "x: [5]", "deck.yaml:2:52: error: include: with: x must be text or a number"),
        ("with: {car: front", "such: {car: front", "deck.yaml:2:22: error: include: unknown field"),
        ("file: car.yaml, with: {car: front", "with: {car: front", "deck.yaml:2:5: error: include"),
        (
            "rear, mass: m_2, x: -3 mm",
            "front, mass: m_1, x: 5",
            "deck.yaml:3:5: error: include: the file is included twice with the same words",
        ),
    ],
)
def test_words_that_do_not_fit_a_file_are_refused(
    tmp_path: Path, before: str, after: str, reported: str
) -> None:
    (tmp_path / "car.yaml").write_text(CAR)
    assert before in TWO_CARS
    lines = messages(tmp_path, TWO_CARS.replace(before, after))
    assert any(line.startswith(reported) for line in lines), lines


def test_errors_stand_in_the_order_of_the_files(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("bodies:\n  wagon: {mass: 0, inertia: [1, 1, 1]}\n")
    lines = messages(tmp_path, "include: [a.yaml]\ncontrol: {end_time: -1}\ntitle: 3\n")
    assert [line.split(": error")[0] for line in lines] == [
        "deck.yaml:2:21",
        "deck.yaml:3:8",
        "a.yaml:2:17",
    ]


def test_an_error_found_while_building_has_its_location(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, TRAIN)
    entry = deck.entries["bodies"]["front"]
    error = deck.error(entry, "rotation.euler", "cannot be", "try another")
    assert (error.line, error.column) == (11, 16)
    assert str(error).endswith("body 'front': rotation.euler: cannot be; try another")
    assert deck.error(entry, None, "cannot be").line == 7
    assert deck.error(entry, "velocity.1", "cannot be").column == 28


def test_a_byte_order_mark_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "deck.yaml").write_bytes(b"\xef\xbb\xbfcontrol: {end_time: 1}\n")
    assert read_deck(tmp_path / "deck.yaml").title == "deck"


def test_text_may_hold_numbers_of_parameters(tmp_path: Path) -> None:
    deck = deck_of(
        tmp_path,
        'title: "n = ${n}, ${n/4}"\nparameters: {n: 3, k: -2, F: 2 kN}\ncontrol: {end_time: 1}\n'
        'curves:\n  f: {type: formula, expression: "${F}*x + ${k}**2", from: 0, to: 1}\n',
    )
    assert deck.title == "n = 3, 0.75"
    assert deck.entries["curves"]["f"].card.expression == "2000.0*x + (-2)**2"


SYMBOLS = """\
control: {end_time: 1, dt: 1e-3}
materials:
  steel: {type: elastoplastic, E: 2e11, nu: 0.3, rho: 7850, yield: 3e8}
bodies:
  ball: {m: 1, I: [1, 1, 1], v: [1, 0, 0], mass: 1, inertia: [1, 1, 1]}
surfaces:
  ball: {type: sphere, body: ball, r: 1}
  floor: {type: plane}
contacts:
  touch: {a: [ball], b: [floor], normal: {type: hertz, k: 1e6, e: 1.5},
    friction: {type: coulomb, mu: 0.3}}
loads:
  weight: {type: gravity, g: [0, 0, -9.81]}
"""
MEANT = {
    **{"dt": "step", "E": "young", "nu": "poisson", "rho": "density", "yield": "yield_stress"},
    **{"m": "mass", "I": "inertia", "v": "velocity", "r": "radius", "k": "stiffness"},
    **{"e": "exponent", "mu": "friction_coefficient", "g": "acceleration"},
}


def test_symbols_of_textbooks_get_the_field_that_is_meant(tmp_path: Path) -> None:
    lines = [line for line in messages(tmp_path, SYMBOLS) if "unknown field" in line]
    for line, (symbol, field) in zip(lines, MEANT.items(), strict=True):
        assert f"unknown field '{symbol}'; did you mean '{field}'? (fields: " in line


MISTYPED = """\
control: {end_time: 1, threads: 2}
materials:
  steel: {type: elastik, young: "${E}", poison: 0.3}
sections: {s: {type: circle, radius: 1}}
parts:
  rod: {type: beem, section: s, material: steal, colour: 3,
    mesh: {shape: line, from: [0, 0, 0], to: [1, 0, 0], elements: 2}}
joints:
  end: {type: spherical, a: rod_end, b: ground, at: [0, 0]}
  pin: {type: revolut, a: rood, b: ground, at: [0, 0, 0], axis: [0, 0, 1]}
surfaces:
  floor: {type: plane}
contacts:
  touch: {a: [flor], b: [floor], normal: {type: hertzz, k: 3}}
"""
BESIDE = (
    "3:17: error: material 'steel': unknown type 'elastik'; did you mean 'elastic'?",
    "3:33: error: material 'steel': unknown parameter 'E'",
    "3:41: error: material 'steel': unknown field 'poison'; did you mean 'poisson'?",
    "6:15: error: part 'rod': unknown type 'beem'; did you mean 'beam'?",
    "6:43: error: part 'rod': material: unknown material 'steal'; did you mean 'steel'?",
    "6:50: error: part 'rod': unknown field 'colour'",
    "9:49: error: joint 'end': at: must have 3 values, not 2",
    "10:15: error: joint 'pin': unknown type 'revolut'; did you mean 'revolute'?",
    "10:27: error: joint 'pin': a: unknown body 'rood'",
    "14:15: error: contact 'touch': a: unknown surface 'flor'; did you mean 'floor'?",
    "14:49: error: contact 'touch': normal: unknown type 'hertzz'; did you mean 'hertz'?",
    "14:57: error: contact 'touch': normal: unknown field 'k'; did you mean 'stiffness'?",
)


def test_an_unknown_type_hides_no_other_error_and_makes_none_up(tmp_path: Path) -> None:
    # neither the node of the part that cannot be read nor its missing shell is complained of
    lines = messages(tmp_path, MISTYPED)
    assert len(lines) == len(BESIDE)
    for line, start in zip(lines, BESIDE, strict=True):
        assert line.removeprefix("deck.yaml:").startswith(start)
