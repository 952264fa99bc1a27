"""One number from a history."""

import numpy as np
import pytest

from crashpost.errors import PostError
from crashpost.expression import Series
from crashpost.statistic import statistic, unit_of, within

RAMP = Series(np.array([0.0, 1.0, 4.0]), np.array([2.0, -6.0, 6.0]), "N")


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("max", 6.0),
        ("min", -6.0),
        ("abs_max", 6.0),
        ("final", 6.0),
        ("integral", -2.0),
        ("mean", -0.5),
        ("argmax", 4.0),
        ("argmin", 1.0),
        ("at:0", 2.0),
        ("at:1", -6.0),
        ("at:0.25", 0.0),
        ("at:2.5", 0.0),
        ("at:4e0", 6.0),
    ],
)
def test_values_by_hand(word: str, expected: float) -> None:
    assert statistic(RAMP, word) == expected


def test_a_sample_hit_exactly_is_returned_bit_for_bit() -> None:
    time = np.linspace(0, 1, 1001)
    values = np.random.default_rng(1).normal(size=1001)
    for k in (0, 137, 1000):
        assert statistic(Series(time, values, "m"), f"at:{float(time[k])!r}") == values[k]


def test_a_single_sample_has_every_statistic() -> None:
    one = Series(np.array([0.5]), np.array([3.0]), "m")
    assert statistic(one, "mean") == statistic(one, "at:0.5") == 3.0
    assert statistic(one, "integral") == 0.0


@pytest.mark.parametrize(
    ("word", "words"),
    [
        ("at:5", "outside the samples, 0 s to 4 s"),
        ("at:-1", "outside the samples"),
        ("at:nan", "is not a time"),
        ("at:soon", "is not a time"),
        ("maximum", "did you mean 'max'"),
        ("absmax", "did you mean 'abs_max'"),
    ],
)
def test_refusals_say_what_is_wrong(word: str, words: str) -> None:
    with pytest.raises(PostError) as refusal:
        statistic(RAMP, word)
    assert words in str(refusal.value)


def test_an_empty_history_has_no_statistic() -> None:
    with pytest.raises(PostError, match="no samples yet"):
        statistic(Series(np.empty(0), np.empty(0), "m"), "max")


def test_windows_are_closed_and_never_empty() -> None:
    assert list(within(RAMP, (1.0, 4.0)).time) == [1.0, 4.0]
    with pytest.raises(PostError, match="no sample between"):
        within(RAMP, (1.5, 2.0))


def test_times_come_in_seconds_and_integrals_with_a_second_more() -> None:
    assert unit_of("argmax", "N") == "s"
    assert unit_of("integral", "N") == "N s"
    assert unit_of("max", "N") == "N"
