"""Claim: a card holds SI numbers, and says in words what is wrong."""

import math
from typing import Literal

import pytest
from pydantic import ValidationError, model_validator

from crashsolve.channels.units import BASES, parse_unit
from crashsolve.deck.card import BodyName, Card, Rotation, Vec3, quantity, word
from crashsolve.deck.diagnostics import diagnostics_of
from crashsolve.deck.numbers import Context, SiFloat


class Inner(Card):
    """A table within a card."""

    length: float = quantity("m", "length", gt=0)


class Sample(Card):
    """One field of each kind."""

    body: BodyName = word("body", "ground")
    step: float | Literal["auto"] = quantity("s", "step", "auto", gt=0)
    exponent: float = quantity("1", "power", 1.5)
    stiffness: float | None = quantity("N/m^{exponent}", "stiffness", None, ge=0)
    at: Vec3 = quantity("m", "point", (0.0, 0.0, 0.0), ge=0)
    points: tuple[Vec3, ...] = quantity("m", "points", ())
    count: int | Literal["all"] = word("count", 1, ge=1)
    divisor: Literal[1, 2, 4] = word("number of a few", 1)
    flag: bool = word("flag", False)
    names: tuple[BodyName, ...] = word("names", ())
    inner: Inner | None = word("inner table", None)
    from_: float = quantity("m", "a word of Python", 0.0)

    @model_validator(mode="after")
    def _rule(self) -> "Sample":
        if self.flag and self.count == 7:
            raise ValueError("count: must not be 7")
        if self.flag and self.count == 8:
            raise ValueError("the eighth is not allowed")
        return self


def diagnostic(**fields: object) -> tuple[object, ...]:
    with pytest.raises(ValidationError) as caught:
        Sample.model_validate(fields)
    (reported,) = diagnostics_of(Sample, caught.value)
    return reported.path, reported.message


def test_numbers_are_in_si() -> None:
    card = Sample.model_validate(
        {
            "stiffness": "1 N/mm^1.5",
            "at": ["1 mm", 2, 3.5],
            "points": [["1 km", 0, 0], [1, 2, 3]],
            "inner": {"length": "1 ft"},
            "from": "1 cm",
        }
    )
    assert card.stiffness == pytest.approx(1000**1.5)
    assert card.at == (0.001, 2.0, 3.5)
    assert card.points == ((1000.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    assert card.inner == Inner(length=0.3048)
    assert card.from_ == 0.01
    assert card.step == "auto"


def test_bare_numbers_are_in_the_units_of_the_file() -> None:
    names = zip(BASES, ("mm", "t", "ms", "deg"), strict=True)
    context = Context({base: parse_unit(name) for base, name in names})
    metre = parse_unit("m")
    card = Sample.model_validate(
        {"at": [1, "1 m", SiFloat(5.0, metre, metre)], "step": 2, "stiffness": 1.0, "exponent": 1},
        context=context,
    )
    assert card.at == (0.001, 1.0, 5.0)
    assert card.step == 0.002
    assert card.stiffness == pytest.approx(1e9)


@pytest.mark.parametrize(
    ("fields", "path", "message"),
    [
        ({"step": 0}, ("step",), "must be greater than 0 s, not 0"),
        ({"step": "3 m"}, ("step",), "must be a number in s or 'auto'"),
        ({"step": True}, ("step",), "must be a number in s or 'auto', not true"),
        ({"stiffness": "1 N/m"}, ("stiffness",), "must be a number in N/m^1.5"),
        ({"at": [1, 2, -3]}, ("at", 2), "must be at least 0 m, not -3"),
        ({"at": [1, 2]}, ("at",), "must have 3 values, not 2"),
        ({"at": []}, ("at",), "must have 3 values, not 0"),
        ({"at": "1 m"}, ("at",), "must be a list of 3 numbers in m, not 1"),
        ({"points": [[1, 2, 3], [1, 2]]}, ("points", 1), "must have 3 values, not 2"),
        ({"points": [1]}, ("points", 0), "must be a list of 3 numbers, not 1"),
        ({"points": [[1, 2, None]]}, ("points", 0, 2), "must be a number in m, not empty"),
        ({"count": 0}, ("count",), "must be at least 1, not 0"),
        ({"count": "some"}, ("count",), "must be a whole number or 'all', not 'some'"),
        ({"count": 2.0}, ("count",), "must be a whole number or 'all', not 2"),
        ({"count": True}, ("count",), "must be a whole number or 'all', not true"),
        ({"divisor": 3}, ("divisor",), "must be 1, 2 or 4, not 3"),
        ({"divisor": "two"}, ("divisor",), "must be 1, 2 or 4, not 'two'"),
        ({"flag": "yes"}, ("flag",), "must be true or false, not 'yes'"),
        ({"flag": 1}, ("flag",), "must be true or false, not 1"),
        ({"names": "wagon"}, ("names",), "must be a list, not 'wagon'"),
        ({"names": ["a", 3]}, ("names", 1), "must be text, not 3"),
        ({"inner": 3}, ("inner",), "must be a table of fields, not 3"),
        ({"inner": {}}, ("inner", "length"), "missing field 'length' (length, in m)"),
        ({"inner": {"width": 1, "length": 1}}, ("inner", "width"), "unknown field 'width'"),
        ({"exponent": 10**400}, ("exponent",), "must be a number"),
        ({"exponent": math.inf}, ("exponent",), "must be a finite number, not inf"),
        ({"from_": 3, "flag": True, "count": 7}, ("count",), "must not be 7"),
        ({"flag": True, "count": 8}, (), "the eighth is not allowed"),
    ],
)
def test_an_error_has_its_location_and_words(
    fields: dict[str, object], path: tuple[str | int, ...], message: str
) -> None:
    assert diagnostic(**fields) == (path, message)


def test_all_errors_of_a_card_are_found() -> None:
    with pytest.raises(ValidationError) as caught:
        Sample.model_validate({"step": -1, "at": [1], "inner": {"length": 0}, "extra": 1})
    diagnostics = diagnostics_of(Sample, caught.value)
    assert {m.path for m in diagnostics} == {("step",), ("at",), ("inner", "length"), ("extra",)}


HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("fields", "quaternion"),
    [
        ({}, (1, 0, 0, 0)),
        ({"axis": [0, 0, 5], "angle": "90 deg"}, (HALF, 0, 0, HALF)),
        ({"axis": [0, 0, 5e-324], "angle": "90 deg"}, (HALF, 0, 0, HALF)),
        ({"axis": [0, 0, 1e308], "angle": "90 deg"}, (HALF, 0, 0, HALF)),
        ({"quaternion": [HALF, 0, HALF, 0]}, (HALF, 0, HALF, 0)),
        ({"euler": ["90 deg", 0, 0]}, (HALF, HALF, 0, 0)),
        ({"euler": ["90 deg", 0, "90 deg"], "sequence": "zxz"}, (0, 0, 0, 1)),
        # about z, then about the new x: body y ends along the world's z
        ({"euler": ["90 deg", "90 deg", 0], "sequence": "zxy"}, (0.5, 0.5, 0.5, 0.5)),
    ],
)
def test_rotation(fields: dict[str, object], quaternion: tuple[float, ...]) -> None:
    assert Rotation.model_validate(fields).quaternion() == pytest.approx(quaternion, abs=1e-15)
