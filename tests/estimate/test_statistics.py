"""Claim: a run's own arithmetic is that of crashpost, and refined numbers see between samples."""

import numpy as np
import pytest

from crashpost.expression import Series as PostSeries
from crashpost.expression import evaluate as post_evaluate
from crashpost.statistic import statistic as post_statistic
from crashsolve.deck.statistic import STATISTICS
from crashsolve.estimate.expression import channels_in, evaluate
from crashsolve.estimate.statistic import Series, plain, refined, unresolved

TIME = np.linspace(0.0, 2.0, 61)
CHANNELS = {
    "rbdout.a.position.x": 0.3 + np.sin(4.0 * TIME),
    "rbdout.a.position.y": np.cos(3.0 * TIME),
    "rbdout.car-b.velocity.x": 2.0 + TIME**2,
}
EXPRESSIONS = (
    "rbdout.a.position.x",
    "-rbdout.a.position.x + 2 * rbdout.a.position.y",
    "norm(rbdout.a.position.x, rbdout.a.position.y)",
    "abs(rbdout.a.position.y) / 'rbdout.car-b.velocity.x'",
    "time * integral(rbdout.a.position.x)",
    "derivative('rbdout.car-b.velocity.x')",
)


@pytest.mark.parametrize("text", EXPRESSIONS)
@pytest.mark.parametrize("word", [*STATISTICS, "at:0.77"])
def test_numbers_are_those_of_crashpost(text: str, word: str) -> None:
    def lookup(name: str) -> PostSeries:
        # without units, which are crashpost's to judge
        return PostSeries(TIME, TIME if name == "time" else CHANNELS[name], "")

    own = evaluate(text, TIME, CHANNELS)
    other = post_evaluate(text, lookup)
    np.testing.assert_array_equal(own, other.values)
    # the same sums, in another order of the weights of at:T
    assert plain(Series(TIME, own), word) == pytest.approx(post_statistic(other, word), rel=1e-14)


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
