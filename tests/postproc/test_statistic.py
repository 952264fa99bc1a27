"""One number from a history."""

import numpy as np
import pytest

from crashpost.errors import PostError
from crashsolve.channels.series import Series, within
from crashsolve.channels.statistic import statistic, unit_of

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


def test_windows_are_closed() -> None:
    assert list(within(RAMP, (1.0, 4.0)).time) == [1.0, 4.0]


@pytest.mark.parametrize(
    ("word", "during", "expected"),
    [
        ("max", (0.0, 1.0), 2.0),
        ("min", (1.0, 4.0), -6.0),
        ("abs_max", (0.0, 0.5), 2.0),
        # a sample at 0 s and one at 1 s: what lies beyond them up to 3.9 s is not guessed
        ("integral", (0.0, 3.9), -2.0),
        ("mean", (0.0, 3.9), -2.0),
        ("argmax", (0.5, 4.0), 4.0),
        ("argmin", (0.0, 0.5), 0.0),
    ],
)
def test_a_window_leaves_the_samples_within_it(
    word: str, during: tuple[float, float], expected: float
) -> None:
    assert statistic(RAMP, word, during) == expected


@pytest.mark.parametrize(
    ("word", "during", "words"),
    [
        ("max", (1.5, 2.0), "no sample from 1.5 s to 2 s"),
        ("max", (2.0, 1.0), "no sample from 2 s to 1 s"),
        ("max", (3.0, 4.5), "3 s to 4.5 s is outside the samples, 0 s to 4 s"),
        ("max", (-1.0, 4.0), "outside the samples"),
        ("max", (float("nan"), 4.0), "outside the samples"),
        ("final", (0.0, 4.0), "'final' reads one moment, which no time window limits"),
        ("at:1", (0.0, 4.0), "'at:1' reads one moment"),
    ],
)
def test_a_window_without_meaning_is_refused(
    word: str, during: tuple[float, float], words: str
) -> None:
    with pytest.raises(PostError) as refusal:
        statistic(RAMP, word, during)
    assert words in str(refusal.value)


def test_times_come_in_seconds_and_integrals_with_a_second_more() -> None:
    assert unit_of("argmax", "N") == "s"
    assert unit_of("integral", "N") == "N s"
    assert unit_of("max", "N") == "N"
