"""Claim: what a family or a law declares wrongly is one error in words, when it is imported."""

from types import ModuleType
from typing import Any, Protocol

import numpy as np
import pytest

from crashsolve.channels.units import UnitError
from crashsolve.deck.card import Card
from crashsolve.deck.family import (
    LINE,
    Family,
    FamilyError,
    _refuse_clashes,
    check_law,
    families,
)
from crashsolve.deck.fields import quantity
from crashsolve.deck.roles import Built, Force
from crashsolve.foundation.record import Record
from crashsolve.integrators import dormand_prince_5
from crashsolve.materials import elastic
from crashsolve.model.checks.methods import refuse_incomplete_method
from crashsolve.model.materials import refuse_different, refuse_incomplete
from crashsolve.springs import linear


class RopeLaw(Built, Force, Protocol):
    """What the file of a rope provides."""


class Bare(Force, Protocol):
    """A law that is not built."""


DECLARED: dict[str, Any] = {
    "entry": "tether",
    "follows": "springs",
    "law": RopeLaw,
    "energy": ("tether",),
    "channels": {"tetherout": "tension of tethers"},
    "picture": LINE,
    "uses": (),
    "integrators": ("rattle",),
}


def declared(**other: Any) -> Family:
    return Family(**(DECLARED | other))


def test_the_declaration_as_it_should_be_is_taken() -> None:
    assert declared().name == ""
    _refuse_clashes([*families().values(), declared(folder="tethers")])


@pytest.mark.parametrize("name", DECLARED)
def test_a_declaration_that_is_forgotten_is_named(name: str) -> None:
    rest = {word: value for word, value in DECLARED.items() if word != name}
    with pytest.raises(FamilyError, match=f"a family must declare {name}: see the fields of Fam"):
        Family(**rest)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("entry", 3),
        ("entry", ""),
        ("follows", None),
        ("law", None),
        ("law", "RopeLaw"),
        ("law", Protocol),
        ("law", Bare),
        ("energy", "tether"),
        ("energy", None),
        ("energy", (3,)),
        ("energy", ("tether", "tether")),
        ("energy", ("of ropes",)),
        ("energy", ()),
        ("channels", "tetherout"),
        ("channels", ("tetherout",)),
        ("channels", {"tetherout": None}),
        ("channels", {"tether.out": "tension"}),
        ("channels", {}),
        ("channels", None),
        ("picture", "lines"),
        ("picture", True),
        ("uses", "springs"),
        ("uses", None),
        # `in` of a text would find any part of the word
        ("integrators", "rattle"),
        ("integrators", ()),
        ("integrators", None),
        ("default", 3),
        ("section", 3),
        ("at_rest", "no"),
    ],
)
def test_a_declaration_of_a_wrong_kind_is_refused(name: str, value: object) -> None:
    with pytest.raises(FamilyError, match=name):
        declared(**{name: value})


@pytest.mark.parametrize(
    ("other", "reported"),
    [
        ({"section": "springs"}, "section 'springs' is that of crashsolve/springs"),
        ({"energy": ("spring",)}, "energy 'spring' is that of crashsolve/springs"),
        ({"channels": {"rcforc": "x"}}, "channels 'rcforc' is that of crashsolve/contact"),
        ({"channels": {"glstat": "x"}}, "channels 'glstat' is that of the whole model"),
        ({"uses": ("ropes",)}, "uses names 'ropes', which is none of belts, bodies, "),
        ({"integrators": ("rattl",)}, "integrators names 'rattl', which is none of dormand_"),
        ({"default": "rope"}, "default 'rope' has no file in its folder"),
    ],
)
def test_names_that_are_taken_or_unknown_are_refused(
    other: dict[str, object], reported: str
) -> None:
    family = declared(folder="tethers", **other)
    with pytest.raises(FamilyError, match=f"^crashsolve/tethers/__init__.py: {reported}"):
        _refuse_clashes([*families().values(), family])


def law(source: ModuleType = linear, **other: object) -> ModuleType:
    """A law with some names changed, or left out where they are None."""
    module = ModuleType(f"{source.__package__}.changed")
    for name, value in (vars(source) | other).items():
        if value is not None and not name.startswith("__"):
            setattr(module, name, value)
    return module


def slope(p: Any, rows: Any) -> None: ...


@pytest.mark.parametrize(
    ("other", "reported"),
    [
        ({"PARAMETERS": None}, "changed must provide PARAMETERS: Record"),
        ({"OUTPUT": None}, "changed must provide OUTPUT: Record"),
        ({"PARAMETERS": {}}, "PARAMETERS must be Record"),
        ({"HISTORY": {}}, "HISTORY must be Record"),
        ({"tangent": None}, "TANGENTS and tangent belong together"),
        ({"TANGENTS": None}, "TANGENTS and tangent belong together"),
        ({"tangent": slope}, r"must provide tangent\(p, state, nodes, .*not tangent\(p, rows\)"),
        ({"event": slope}, r"must provide event\(p, old, h, nodes, curves\), not event\(p, rows\)"),
        ({"build": 3}, "build must be a function"),
        ({"force": 3}, "force must be a function"),
        # a text in place of a tuple would be taken letter by letter
        ({"CURVES_OF_TIME": "stiffness"}, "CURVES_OF_TIME must name columns, in a tuple, of PARAM"),
        ({"CURVES_OF_TIME": ("none",)}, "CURVES_OF_TIME must name columns, in a tuple, of PARAM"),
        ({"AMPLITUDE": "none"}, "AMPLITUDE must name a column of PARAMETERS"),
        ({"LEDGER": "hemp"}, "must be one of spring, joint, brake, as declared"),
    ],
)
def test_what_a_law_lacks_or_has_wrongly_is_reported(other: dict[str, Any], reported: str) -> None:
    check_law(law())
    with pytest.raises(FamilyError, match=reported):
        check_law(law(**other))


@pytest.mark.parametrize(
    ("other", "reported"),
    [
        (
            {"tangent": None},
            "materials.changed must provide tangent, as GeneralLaw of mat",
        ),
        ({"VON_MISES": True}, "must provide HEATS, SMOOTH, flow, heat_factor, line, .*VonMisesLaw"),
        (
            {"tangent": slope},
            r"must provide tangent\(m, blocks_before, blocks, .*not tangent\(p, rows\)",
        ),
    ],
)
def test_what_a_material_lacks_is_reported(other: dict[str, object], reported: str) -> None:
    refuse_incomplete(law(elastic))
    with pytest.raises(FamilyError, match=reported):
        refuse_incomplete(law(elastic, **other))


@pytest.mark.parametrize(
    ("other", "reported"),
    [
        ({name: None}, f"integrators.changed must declare {name}")
        for name in ("ORDER", "STAGES", "EXTRA", "A", "C", "DENSE", "TERMS", "E", "ESTIMATES")
    ]
    + [
        (
            {"STEPPER": "_runge"},
            "STEPPER must be one of _kick_drift_kick, _runge_kutta, _implicit, or left out",
        ),
        ({"STEPPER": None}, "must declare prepare_sample, take_step"),
        # compiled steps would read beyond the end
        ({"ESTIMATES": 2}, r"E has the shape \(1, 7\), not \(2, 7\)"),
        ({"EXTRA": 1}, r"A has the shape \(7, 7\), not \(8, 8\)"),
    ],
)
def test_what_a_method_of_integration_lacks_is_reported(
    other: dict[str, object], reported: str
) -> None:
    refuse_incomplete_method(law(dormand_prince_5))
    with pytest.raises(FamilyError, match=reported):
        refuse_incomplete_method(law(dormand_prince_5, **other))


COLUMNS = Record("""
    k             N/m       stiffness
    u             1      3  direction
    first_member  index     place
""")


@pytest.mark.parametrize(
    ("values", "reported"),
    [
        ({"u": (0, 0, 1)}, "nothing for 'k' of PARAMETERS"),
        ({"k": 1.0, "u": (0, 0, 1), "c": 2.0}, "'c', which PARAMETERS has not"),
        # a number would be written into all three positions
        ({"k": 1.0, "u": 1.0}, "1.0 for 'u', which has 3 numbers"),
        ({"k": (1.0, 2.0), "u": (0, 0, 1)}, "for 'k', which has 1 number"),
        ({"k": "stiff", "u": (0, 0, 1)}, "'stiff' for 'k', which has 1 number"),
        (None, "must return a dict of columns, not None"),
    ],
)
def test_a_row_that_does_not_fit_its_columns_is_refused(values: Any, reported: str) -> None:
    later = ("first_member",)
    refuse_different(linear, COLUMNS, {"k": 1.0, "u": np.ones(3)}, later)
    with pytest.raises(FamilyError, match=f"springs.linear: build .*{reported}"):
        refuse_different(linear, COLUMNS, values, later)


def test_a_field_that_is_not_declared_is_refused() -> None:
    with pytest.raises(TypeError, match="length of Rope must be declared: quantity"):
        type("Rope", (Card,), {"__annotations__": {"length": float}, "length": 0.3})


def test_a_quantity_has_a_known_unit_and_a_meaning() -> None:
    with pytest.raises(UnitError, match="furlong"):
        quantity("furlong", "length")
    for unit, meaning in (("", "length"), ("m", "")):
        with pytest.raises(ValueError, match="a quantity has a unit"):
            quantity(unit, meaning)
