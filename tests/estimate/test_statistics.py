"""Claim: refined numbers see between samples, and say where they cannot."""

import numpy as np
import pytest

from crashsolve.channels.expression import channels_in
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import plain, refined, unresolved
from crashsolve.channels.statistics._top import heights


@pytest.mark.parametrize(
    "text", ["1 + 2", "sin(rbdout.a.position.x)", "a.b.c +", "abs()", "a ** 2"]
)
def test_an_expression_that_cannot_be_read_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="names no channel|unknown|cannot read|takes|is not"):
        channels_in(text)


@pytest.mark.parametrize(
    ("word", "truth"),
    [
        ("max", 1.0),
        ("min", -1.0),
        ("argmax", 0.5 * np.pi / 7.0),
        ("argmin", 1.5 * np.pi / 7.0),
        ("mean", (1.0 - np.cos(7.0)) / 7.0),
        ("integral", (1.0 - np.cos(7.0)) / 7.0),
        ("at:0.3333", np.sin(7.0 * 0.3333)),
    ],
)
def test_a_refined_number_is_ten_times_nearer(word: str, truth: float) -> None:
    # 27 samples a period; their number is odd, so that Simpson's rule meets the end
    time = np.linspace(0.0, 1.0, 31)
    series = Series(time, np.sin(7.0 * time))
    assert abs(refined(series, word) - truth) < 0.1 * abs(plain(series, word) - truth)


@pytest.mark.parametrize("peak", [0.4, 0.413, 0.45, 0.49, 0.5])
@pytest.mark.parametrize("word", ["max", "abs_max"])
def test_a_corner_between_samples_is_where_both_sides_meet(word: str, peak: float) -> None:
    time = np.linspace(0.0, 1.0, 21)
    series = Series(time, np.where(time < peak, 3.0 * time, 3.0 * peak - 2.0 * (time - peak)))
    assert refined(series, word) == pytest.approx(3.0 * peak, rel=1e-12)
    assert refined(series, "argmax") == pytest.approx(peak, rel=1e-12)


@pytest.mark.parametrize("peak", [0.41, 0.424, 0.44])
def test_a_corner_of_sides_that_bend_is_where_they_meet(peak: float) -> None:
    # loading that softens, and unloading that does: slopes change by a seventh of the corner
    time = np.linspace(0.0, 1.0, 21)
    past = time - peak
    series = Series(time, 1.0 + np.where(past < 0.0, 3.0 * past - 6.0 * past**2, -4.0 * past))
    # half of what straight lines miss, 6 h^2 at most with h = 0.05
    assert refined(series, "max") == pytest.approx(1.0, abs=0.5 * 6.0 * 0.05**2)
    assert refined(series, "max") != plain(series, "max")


@pytest.mark.parametrize("start", [0.02, 0.13, 0.19])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("lead", [0, 1])
def test_an_integral_knows_what_a_long_interval_hides(start: float, sign: int, lead: int) -> None:
    # a force that begins at `start`, and is known in short steps from 0.2 on
    time = np.concatenate([np.linspace(-0.2 * lead, 0.0, lead + 1), np.linspace(0.2, 0.4, 41)])
    series = Series(time, np.maximum(0.0, 5.0 * (time - start)))
    if sign < 0:
        series = Series(-time[::-1], series.values[::-1])
    truth = 2.5 * (0.4 - start) ** 2
    missed = plain(series, "integral") - truth
    assert missed > 0.0
    stated = plain(series, "integral") - refined(series, "integral")
    assert missed / 10.0 < stated < 10.0 * missed
    if lead == 0 and start > 0.1:
        # a straight line that ends in a constant; of two long intervals a parabola meets both
        assert stated == pytest.approx(missed, rel=1e-9)


@pytest.mark.parametrize("lead", [0, 1, 2])
def test_an_integral_knows_that_a_force_begins_with_a_jump(lead: int) -> None:
    # a damped contact, of 3 - 10 t from the onset on, after a step of 20 times the others
    flight = np.linspace(-0.2 * (lead + 1), -0.2, lead + 1)
    time = np.concatenate([flight, np.linspace(0.0, 0.2, 21)])
    series = Series(time, np.where(time < 0.0, 0.0, 3.0 - 10.0 * time))
    truth = 0.4
    stated = plain(series, "integral") - refined(series, "integral")
    assert stated == pytest.approx(plain(series, "integral") - truth, rel=1e-9)


@pytest.mark.parametrize("peak", [0.02, 0.97])
def test_a_top_beside_the_first_or_last_sample_is_seen(peak: float) -> None:
    time = np.linspace(0.0, 1.0, 11)
    series = Series(time, 1.0 - (time - peak) ** 2)
    assert refined(series, "max") == pytest.approx(1.0, rel=1e-12)
    assert refined(series, "argmax") == pytest.approx(peak, rel=1e-9)


@pytest.mark.parametrize("peak", [-0.02, 1.03])
def test_a_history_that_leaves_its_extreme_has_no_other(peak: float) -> None:
    time = np.linspace(0.0, 1.0, 11)
    series = Series(time, 1.0 - (time - peak) ** 2)
    assert refined(series, "max") == plain(series, "max")


def test_samples_near_tops_of_equal_height_may_all_be_the_greatest() -> None:
    time = np.linspace(0.0, 1.0, 58)
    series = Series(time, np.sin(6.0 * np.pi * time))
    near = heights(series) >= series.values.max()
    tops = [(k + 0.25) / 3.0 for k in range(3)]
    assert all(np.abs(time[near] - top).min() < 1.0 / 57.0 for top in tops)
    assert all(min(abs(t - top) for top in tops) < 1.0 / 57.0 for t in time[near])


def test_of_many_tops_the_highest_counts_though_no_sample_is_near_it() -> None:
    # tops of 1.01, 1.02 ... 1.06, of which samples miss the last by half an interval
    time = np.linspace(0.0, 6.0, 6 * 40 + 1)
    size = 1.0 + 0.01 * np.ceil(time + 1e-9)
    series = Series(time, size * np.cos(2.0 * np.pi * (1.0 + 0.5 / 240.0) * (time - 0.5)))
    times = np.linspace(0.0, 6.0, 600001)
    truth = (1.0 + 0.01 * np.ceil(times + 1e-9)) * np.cos(
        2.0 * np.pi * (1.0 + 0.5 / 240.0) * (times - 0.5)
    )
    assert refined(series, "max") == pytest.approx(truth.max(), rel=1e-4)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_jump_beside_the_top_has_no_parabola(sign: int) -> None:
    time = np.linspace(0.0, 1.0, 101)
    values = np.where(time < 0.504, 1400.0 + 40.0 * time, 280.0 + 40.0 * time)[::sign]
    # the line ends at 1420.16 at most, and no parabola of 1550 is seen
    assert 1420.0 < refined(Series(time, values), "max") < 1420.4


def test_a_jump_to_a_value_that_is_constant_but_for_round_off_has_no_parabola() -> None:
    values = np.where(np.arange(21) < 12, 1.0, 321.2) * (1.0 + 1e-13 * np.sin(np.arange(21.0)))
    series = Series(np.linspace(0.0, 1.0, 21), values)
    assert refined(series, "max") == pytest.approx(321.2, rel=1e-12)


@pytest.mark.parametrize("samples", [9, 12, 21, 301])
def test_a_smooth_top_is_no_corner(samples: int) -> None:
    # eight samples and more of a half wave
    time = np.linspace(0.0, 1.0, samples)
    series = Series(time, np.sin(np.pi * time + 0.03))
    assert refined(series, "max") == pytest.approx(1.0, abs=2e-4)


def test_a_peak_that_one_sample_caught_is_not_trusted() -> None:
    time = np.linspace(0.0, 1.0, 11)
    values = np.where(np.arange(11) == 4, 3.0, 0.0)
    assert unresolved(Series(time, values), "max") == 3.0
    assert unresolved(Series(time, np.sin(3.0 * time)), "max") == 0.0


def test_a_jump_has_no_parabola_and_a_time_known_to_one_sample() -> None:
    time = np.linspace(0.0, 1.0, 11)
    count = Series(time, np.where(time > 0.45, 2.0, 0.0))
    assert refined(count, "max") == plain(count, "max") == 2.0
    assert unresolved(count, "max") == 0.0
    assert refined(count, "argmax") == plain(count, "argmax") == time[5]
    assert unresolved(count, "argmax") == pytest.approx(0.1)
    fall = Series(time, -count.values)
    assert unresolved(fall, "argmin") == pytest.approx(0.1)
    # a smooth top has its parabola
    hill = Series(time, -((time - 0.52) ** 2))
    assert unresolved(hill, "argmax") == 0.0
    assert refined(hill, "argmax") == pytest.approx(0.52)


@pytest.mark.parametrize("word", ["max", "min", "abs_max"])
@pytest.mark.parametrize("samples", [3.3, 3.6, 4.4, 5.5])
def test_a_largest_value_of_few_samples_a_period_states_what_it_may_miss(
    word: str, samples: float
) -> None:
    # a free vibration that decays: its first half waves are the largest, and lie between samples
    for phase in np.linspace(0.0, 2.0 * np.pi, 24):
        time = np.arange(0.0, 9.0, 1.0 / samples)
        x = np.exp(-0.1 * time) * np.cos(2.0 * np.pi * time + phase)
        fine = np.linspace(0.0, time[-1], 20_001)
        truth = np.exp(-0.1 * fine) * np.cos(2.0 * np.pi * fine + phase)
        largest = {"max": truth.max(), "min": truth.min(), "abs_max": np.abs(truth).max()}[word]
        series = Series(time, x)
        # a top before the second sample may be a fall as well
        top = np.argmax({"max": truth, "min": -truth, "abs_max": np.abs(truth)}[word])
        if fine[top] < time[1]:
            continue
        off = abs(plain(series, word) - largest)
        missed = unresolved(series, word) or abs(plain(series, word) - refined(series, word))
        # parabolas through so few samples rise by a half and more of what is missed
        assert off <= 10.0 * missed, (phase, off, missed)


def test_a_largest_value_of_many_samples_a_period_misses_nothing() -> None:
    time = np.linspace(0.0, 5.0, 101)
    for phase in np.linspace(0.0, 2.0 * np.pi, 24):
        series = Series(time, np.exp(-0.1 * time) * np.cos(2.0 * np.pi * time + phase))
        assert all(unresolved(series, word) == 0.0 for word in ("max", "min", "abs_max"))


@pytest.mark.parametrize("word", ["max", "min", "abs_max"])
@pytest.mark.parametrize("samples", [1.9, 1.96, 2.01, 2.04, 2.1, 2.4, 2.9])
@pytest.mark.parametrize("drift", [0.0, 0.3])
def test_a_vibration_that_alternates_from_sample_to_sample_has_no_small_error(
    word: str, samples: float, drift: float
) -> None:
    def history(time: np.ndarray, phase: float) -> np.ndarray:
        wave = np.exp(-0.1 * time) * np.cos(2.0 * np.pi * time + phase)
        values: np.ndarray = wave + drift * np.sin(0.5 * time)
        return values

    for phase in np.linspace(0.0, 2.0 * np.pi, 24):
        time = np.arange(0.0, 9.0, 1.0 / samples)
        truth = history(np.linspace(0.0, time[-1], 20_001), phase)
        largest = {"max": truth.max(), "min": truth.min(), "abs_max": np.abs(truth).max()}[word]
        series = Series(time, history(time, phase))
        off = abs(plain(series, word) - largest)
        # where the samples are near the zeros, they show a tenth of the vibration and more
        assert off <= 10.0 * unresolved(series, word), (phase, off)


def test_what_alternates_after_a_smooth_top_is_no_part_of_it() -> None:
    time = np.linspace(0.0, 5.0, 101)
    chatter = np.where(time > 3.0, 0.1 * (-1.0) ** np.arange(101), 0.0)
    series = Series(time, np.exp(-((time - 1.0) ** 2)) + chatter)
    assert unresolved(series, "max") == 0.0
