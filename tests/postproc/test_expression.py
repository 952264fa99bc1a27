"""Arithmetic on channels."""

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crashpost.errors import PostError, unknown
from crashsolve.channels.expression import evaluate
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import statistic

TIME = np.linspace(0.0, 2.0, 201)
CHANNELS = {
    "rcforc.left.force.normal": (np.sin(TIME), "N"),
    "rcforc.right.force.normal": (np.cos(TIME), "N"),
    "rbdout.car-b.velocity.x": (3 * TIME, "m/s"),
    "rbdout.2.velocity.y": (4 * TIME, "m/s"),
    "glstat.model.energy": (1 + TIME, "J"),
}


def lookup(name: str) -> Series:
    if name == "time":
        return Series(TIME, TIME, "s")
    if name not in CHANNELS:
        raise unknown("channel", name, CHANNELS)
    return Series(TIME, *CHANNELS[name])


@pytest.mark.parametrize(
    ("expression", "expected", "unit"),
    [
        ("rcforc.left.force.normal + rcforc.right.force.normal", np.sin(TIME) + np.cos(TIME), "N"),
        ("-rcforc.left.force.normal", -np.sin(TIME), "N"),
        ("2e-3 * rcforc.left.force.normal", 2e-3 * np.sin(TIME), "N"),
        ("rcforc.left.force.normal - 1", np.sin(TIME) - 1, "N"),
        ("abs(rcforc.left.force.normal)", np.abs(np.sin(TIME)), "N"),
        ("norm('rbdout.car-b.velocity.x', rbdout.2.velocity.y)", 5 * TIME, "m/s"),
        ("rcforc.left.force.normal * rbdout.2.velocity.y", 4 * TIME * np.sin(TIME), "N m/s"),
        ("rbdout.2.velocity.y / glstat.model.energy", 4 * TIME / (1 + TIME), "m/s/J"),
        ("derivative(rbdout.2.velocity.y)", np.full_like(TIME, 4.0), "m/s^2"),
        ("integral(rbdout.2.velocity.y)", 2 * TIME**2, "m"),
        ("-(time * rcforc.left.force.normal) / (1 + 1)", -TIME * np.sin(TIME) / 2, "s N"),
        ("1 / glstat.model.energy", 1 / (1 + TIME), "1/J"),
    ],
)
def test_value_and_unit(expression: str, expected: np.ndarray, unit: str) -> None:
    series = evaluate(expression, lookup)
    np.testing.assert_allclose(series.values, expected, rtol=1e-12, atol=1e-12)
    assert series.unit == unit


def test_a_quotient_has_no_value_where_it_divides_by_zero_and_others_elsewhere() -> None:
    series = evaluate("rbdout.2.velocity.y / rbdout.2.velocity.y", lookup)
    assert np.isnan(series.values[0])
    np.testing.assert_array_equal(series.values[1:], 1.0)
    assert statistic(series, "final") == statistic(series, "max", (0.5, 1.0)) == 1.0
    for word in ("at:0", "max", "mean"):
        with pytest.raises(PostError, match="division by zero"):
            statistic(series, word)


def test_derivative_undoes_integral_to_second_order() -> None:
    series = evaluate("derivative(integral(rcforc.left.force.normal))", lookup)
    assert np.max(np.abs(series.values - np.sin(TIME))) < (TIME[1] - TIME[0]) ** 2


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        ("rcforc.left.force.normal + rbdout.2.velocity.y", "cannot add 'N' and 'm/s'"),
        ("norm(rcforc.left.force.normal, rbdout.2.velocity.y)", "cannot add"),
        ("rcforc.lft.force.normal + 1", "did you mean 'rcforc.left.force.normal'"),
        ("1 + 2", "names no channel"),
        ("integral(1)", "needs a channel"),
        ("abs(1, rbdout.2.velocity.y)", "takes one value"),
        ("sinus(rbdout.2.velocity.y)", "unknown function 'sinus'"),
        ("rbdout.2.velocity.y / 0", "division by zero"),
        ("rbdout.2.velocity.y ** 2", "only + - * / are known"),
        ("rbdout.2.velocity.y +", "cannot read the expression"),
        ("", "cannot read the expression"),
        ("speed", "'speed' is not a channel"),
        ("True * rbdout.2.velocity.y", "'True' is not a channel"),
        ("[rbdout.2.velocity.y]", "is not a channel"),
        ("__import__('os')", "unknown function"),
        ("'rbdout.2.velocity.y'.upper()", "is not a channel"),
        ("(" * 500 + "1" + ")" * 500, "cannot read the expression"),
        ("1+" * 3000 + "1", "longer than"),
    ],
)
def test_refusals_say_what_is_wrong(expression: str, words: str) -> None:
    with pytest.raises(PostError) as refusal:
        evaluate(expression, lookup)
    assert words in str(refusal.value)


def test_channels_sampled_at_other_times_do_not_mix() -> None:
    def uneven(name: str) -> Series:
        shift = 1e-3 if "left" in name else 0.0
        return Series(TIME + shift, TIME, "N")

    with pytest.raises(PostError, match="sampled at other times"):
        evaluate("a.left.f + a.right.f", uneven)


@pytest.mark.parametrize("time", [[0.0], [0.0, 1.0, 1.0]])
def test_derivative_needs_increasing_times(time: list[float]) -> None:
    samples = np.array(time)
    with pytest.raises(PostError, match="strictly increasing"):
        evaluate("derivative(a.b.c)", lambda _: Series(samples, samples, "m"))


@given(st.text(alphabet="abs(.)+-*/ 1e'\"time,[]{}:=\\\n", max_size=40))
def test_any_text_is_a_series_or_a_refusal(text: str) -> None:
    with suppress(PostError):
        assert len(evaluate(text, lookup).values) == len(TIME)
