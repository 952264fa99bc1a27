"""Claim: a table of columns is what its lines say, and a wrong line is refused in words."""

import numpy as np
import pytest

from crashsolve.foundation.record import Column, Record


def test_lines_are_columns() -> None:
    record = Record("""
        point   N m   3  where it is, and
                         what that means
        scale   1        of it
        bodies  count    how many
    """)
    assert record.columns == (
        Column("point", "N m", 3, "where it is, and what that means"),
        Column("scale", "1", 1, "of it"),
        Column("bodies", "count", 1, "how many"),
    )
    assert record.dtype == np.dtype([("point", "f8", (3,)), ("scale", "f8"), ("bodies", "i8")])


@pytest.mark.parametrize(
    "line",
    [
        "mass  kg",
        "mass kg  of it",
        "mass  kg of it",
        "two words  kg  of it",
        "mass  kg  0  of it",
        "mass  kg  -1  of it",
        "mass  kg  three  of it",
        "mass  kg  3  of it  or  not",
    ],
)
def test_a_line_that_is_no_column_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match="is no column: give name, unit"):
        Record(line)


def test_a_name_is_used_once_and_is_not_of_numpy() -> None:
    with pytest.raises(ValueError, match=r"declared twice: \['mass'\]"):
        Record("mass  kg  of it") + Record("mass  kg  of the other")
    with pytest.raises(ValueError, match=r"have already: \['shape'\]"):
        Record("shape  1  of it")
