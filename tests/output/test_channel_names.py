"""Families and columns: how channels are named and which names are refused."""

import pytest

from crashsolve.output.channels import Column, Family

FORCE_X = Column("force", "x", "N", "along the track")
LENGTH = Column("length", "", "m", "present length")


def test_channel_is_family_id_quantity_component() -> None:
    family = Family("deforc", ("buffer", "coupler"), (FORCE_X, LENGTH))
    assert list(family.channels()) == [
        "deforc.buffer.force.x",
        "deforc.buffer.length",
        "deforc.coupler.force.x",
        "deforc.coupler.length",
    ]
    assert FORCE_X.path == "force/x"
    assert LENGTH.path == "length"


@pytest.mark.parametrize("name", ["", "a.b", "a/b"])
def test_name_that_would_not_survive_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="unusable name"):
        Family("deforc", (name,), (LENGTH,))
    with pytest.raises(ValueError, match="unusable name"):
        Family("deforc", ("a",), (Column(name, "", "m", ""),))


@pytest.mark.parametrize(
    ("ids", "columns", "name"),
    [
        (("a", "a"), (LENGTH,), "a"),
        (("a",), (LENGTH, LENGTH), "length"),
        (("a",), (Column("time", "", "s", ""),), "time"),
        (("a",), (Column("force", "", "N", ""), FORCE_X), "force"),
    ],
)
def test_ambiguous_name_is_refused(
    ids: tuple[str, ...], columns: tuple[Column, ...], name: str
) -> None:
    with pytest.raises(ValueError, match=f"name '{name}' used twice"):
        Family("deforc", ids, columns)


def test_unknown_family_is_refused() -> None:
    with pytest.raises(ValueError, match="one of glstat, rbdout"):
        Family("springs", ("a",), (LENGTH,))
