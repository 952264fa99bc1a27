"""Extremes and peaks.txt."""

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crashsolve.output.channels import Column, Family
from crashsolve.output.peaks import Extremes, write_peaks

FAMILY = Family("deforc", ("a", "b"), (Column("force", "", "N", ""), Column("gap", "", "", "")))


@given(
    values=arrays(float, (2, 12, 2), elements=st.floats(-9, 9)),
    cut=st.integers(1, 11),
)
def test_extremes_do_not_depend_on_how_rows_arrive(values: np.ndarray, cut: int) -> None:
    times = np.arange(12.0)
    extremes = Extremes((FAMILY,))
    extremes.update(0, times[:cut], values[:, :cut])
    extremes.update(0, times[cut:], values[:, cut:])
    np.testing.assert_array_equal(extremes.least[0], values.min(axis=1))
    np.testing.assert_array_equal(extremes.greatest[0], values.max(axis=1))
    np.testing.assert_array_equal(extremes.least_time[0], values.argmin(axis=1))
    np.testing.assert_array_equal(extremes.greatest_time[0], values.argmax(axis=1))


EXTREME = np.dtype([("least", float), ("greatest", float), ("at_least", int), ("at_greatest", int)])


@given(
    values=arrays(float, (2, 12, 2), elements=st.floats(-9, 9)),
    cut=st.integers(1, 11),
)
def test_extremes_may_be_found_before(values: np.ndarray, cut: int) -> None:
    times, extremes, expected = np.arange(12.0), Extremes((FAMILY,)), Extremes((FAMILY,))
    expected.update(0, times, values)
    for rows in (slice(0, cut), slice(cut, 12)):
        block = np.zeros((2, 2), EXTREME)
        part = values[:, rows]
        block["least"], block["at_least"] = part.min(axis=1), part.argmin(axis=1)
        block["greatest"], block["at_greatest"] = part.max(axis=1), part.argmax(axis=1)
        extremes.merge(0, times[rows], block)
    for name in ("least", "greatest", "least_time", "greatest_time"):
        np.testing.assert_array_equal(getattr(extremes, name)[0], getattr(expected, name)[0])


def test_table_is_aligned(tmp_path: Path) -> None:
    extremes = Extremes((FAMILY,))
    values = np.array([[[1.0, -1e6], [2.0, 0.5]], [[0.0, 0.0], [-1 / 3, 0.0]]])
    extremes.update(0, np.array([0.0, 0.25]), values)
    write_peaks(tmp_path / "peaks.txt", extremes)
    assert (tmp_path / "peaks.txt").read_text() == (
        "channel         unit        min  at s  max  at s\n"
        "deforc.a.force  N             1     0    2  0.25\n"
        "deforc.a.gap    -     -0.333333  0.25    0     0\n"
        "deforc.b.force  N        -1e+06     0  0.5  0.25\n"
        "deforc.b.gap    -             0     0    0     0\n"
    )
