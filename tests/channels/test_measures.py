"""Claim: measures of injury and filters have their closed forms, and published values of a test."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from crashsolve.channels.errors import ChannelError
from crashsolve.channels.expression import evaluate
from crashsolve.channels.series import Series
from crashsolve.channels.statistic import statistic

NHTSA = Path(__file__).resolve().parents[3] / "shared" / "data" / "nhtsa_10146"
G = 9.80665
Pulse = Callable[[np.ndarray], np.ndarray]
PULSES: dict[str, Pulse] = {
    "half sine": lambda u: np.sin(np.pi * u),
    "triangle": lambda u: 1.0 - np.abs(2.0 * u - 1.0),
    "haversine": lambda u: np.sin(np.pi * u) ** 2,
    "square": np.ones_like,
}
# I1 and I2: over A^2.5 T, and the worst window over T
SI = {"half sine": 0.4576558581, "triangle": 1 / 3.5, "haversine": 0.3395305453, "square": 1.0}
HIC = {"half sine": 0.4146456495, "triangle": 0.2464006574, "haversine": 0.3029388550}
WINDOW = {"half sine": 0.67023, "triangle": 0.57143, "haversine": 0.50759}


def measured(
    expression: str,
    pulse: str,
    peak: float,
    length: float,
    interval: float,
    word: str = "final",
    around: float = 0.05,
) -> float:
    """A statistic of an expression of `a.b.c`, a pulse of `peak` g between two times of rest."""
    time = np.arange(round((length + 2 * around) / interval) + 1) * interval
    share = (time - around) / length
    on = (share > -1e-9) & (share < 1 + 1e-9)
    values = np.where(on, peak * G * PULSES[pulse](np.clip(share, 0, 1)), 0.0)
    return statistic(evaluate(expression, lambda _: Series(time, values, "m/s^2")), word)


@pytest.mark.parametrize("pulse", PULSES)
def test_the_severity_index_has_its_closed_form(pulse: str) -> None:
    measure = measured("si(a.b.c)", pulse, 100, 0.01, 1e-6)
    # trapezoids; a square's jumps count half an interval on either side
    assert measure == pytest.approx(
        SI[pulse] * 100**2.5 * 0.01, rel=2e-4 if pulse == "square" else 1e-7
    )


@pytest.mark.parametrize("pulse", HIC)
def test_the_criterion_without_a_limit_has_its_closed_form(pulse: str) -> None:
    measure = measured("hic(a.b.c)", pulse, 100, 0.01, 1e-5, around=0.002)
    # the window meets whole samples: 1e-3 of its length, to the second power
    assert measure == pytest.approx(HIC[pulse] * 100**2.5 * 0.01, rel=2e-5)
    window = measured("hic_end(a.b.c) - hic_start(a.b.c)", pulse, 100, 0.01, 1e-5, around=0.002)
    # of pulses with a top the window is flat: its ends are known to some samples
    assert window == pytest.approx(WINDOW[pulse] * 0.01, abs=3e-5)


@pytest.mark.parametrize(
    ("pulse", "peak", "length", "limit", "expected"),
    [
        ("half sine", 100, 0.010, "15 ms", 414.6456),
        ("half sine", 80, 0.050, "15 ms", 782.2225),
        ("half sine", 80, 0.050, "36 ms", 1186.7851),
        ("triangle", 80, 0.050, "15 ms", 571.9572),
        ("triangle", 80, 0.050, "36 ms", 705.2398),
        ("square", 60, 0.020, "15 ms", 418.2822),
        ("square", 60, 0.020, "36 ms", 557.7096),
    ],
)
def test_the_criterion_with_a_window_has_its_closed_form(
    pulse: str, peak: float, length: float, limit: str, expected: float
) -> None:
    measure = measured(f"hic(a.b.c, '{limit}')", pulse, peak, length, 5e-5, around=0.02)
    # trapezoids and windows of whole samples: 0.6 (pi h / T)^2 at the shortest pulse
    assert measure == pytest.approx(expected, rel=1.5e-4)


@pytest.mark.parametrize("limit", ["15 ms", "14.3 ms"])
def test_the_criterion_is_of_second_order_in_the_interval(limit: str) -> None:
    """Also where the window is no multiple of the interval."""
    expression = f"hic(a.b.c, '{limit}')"
    w = float(limit.split()[0]) / 50.0 * math.pi / 2.0
    # the mean of a half sine over a window in its middle
    exact = 80**2.5 * (math.sin(w) / w) ** 2.5 * float(limit.split()[0]) / 1000
    for h in (8e-4, 4e-4, 2e-4, 1e-4):
        # trapezoids take 2.5 / 12 (pi h / T)^2, a window that lies h / 2 off the middle 2.5 / 8
        bound = exact * (2.5 / 12 + 2.5 / 8) * (math.pi * h / 0.05) ** 2
        assert abs(measured(expression, "half sine", 80, 0.05, h) - exact) < bound


@pytest.mark.parametrize("count", [0, 1])
@pytest.mark.parametrize("window", ["", ", '15 ms'"])
def test_the_criterion_of_no_window_is_refused(count: int, window: str) -> None:
    nothing = Series(np.zeros(count), np.full(count, 500.0), "m/s^2")
    with pytest.raises(ChannelError, match=f"two samples or more, not {count}"):
        evaluate(f"hic(a.b.c{window})", lambda _: nothing)


def test_the_criterion_so_far_is_that_of_a_shorter_history() -> None:
    time = np.linspace(0, 0.2, 401)
    values = 300 * np.sin(40 * time) ** 2 * np.exp(-5 * time) + 50

    def of(count: int) -> np.ndarray:
        lookup = Series(time[:count], values[:count], "m/s^2")
        return evaluate("hic(a.b.c, '15 ms')", lambda _: lookup).values

    whole = of(401)
    for count in (2, 30, 157):
        assert of(count)[-1] == pytest.approx(whole[count - 1], rel=1e-12)
    assert np.all(np.diff(whole) >= 0)


@pytest.mark.parametrize("interval", [1e-3, 1e-4, 7e-5])
def test_the_clip_has_its_closed_form(interval: float) -> None:
    half_sine = measured("clip(a.b.c, '3 ms')", "half sine", 100, 0.01, interval, around=0.007)
    # chords lie below the sine by (pi h / T)^2 / 8
    bend = (math.pi * interval / 0.01) ** 2 / 8
    exact = 100 * math.cos(math.pi * 0.0015 / 0.01)
    assert exact * (1 - 1.5 * bend) - 1e-9 <= half_sine / G <= exact * (1 + 1e-12)


def test_the_clip_of_straight_lines_is_exact_and_needs_an_unbroken_span() -> None:
    assert measured("clip(a.b.c, '3 ms')", "triangle", 100, 0.01, 7e-5 / 3) / G == pytest.approx(
        70.0, rel=1e-4
    )
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    lookup = Series(time, np.array([0.0, 8.0, 0.0, 8.0, 0.0]), "m")
    history = evaluate("clip(a.b.c, '1 s')", lambda _: lookup).values
    # either peak has a width of 1 s at half its height; both together have 2 s
    np.testing.assert_allclose(history, [0.0, 0.0, 4.0, 4.0, 4.0], atol=1e-12)
    # a run that begins at its peak: no level above 2 is kept for a second
    lookup = Series(time, np.array([8.0, 0.0, 2.0, 2.0, 0.0]), "m")
    history = evaluate("clip(a.b.c, '1 s')", lambda _: lookup).values
    np.testing.assert_allclose(history, [0.0, 0.0, 0.0, 2.0, 2.0], atol=1e-12)


def test_an_envelope_is_the_largest_value_around_each_moment() -> None:
    time = np.linspace(0, 1, 2001)
    lookup = Series(time, np.exp(-time) * np.cos(200 * time), "N")
    series = evaluate("envelope(a.b.c, '33 ms')", lambda _: lookup)
    # a period is 31.4 ms: the greatest peak is at most half the duration away
    assert np.all(series.values >= lookup.values)
    inside = (time > 0.05) & (time < 0.95)
    size = np.exp(-time[inside])
    assert np.all(np.abs(series.values[inside] / size - 1.0) < 0.02)
    assert series.unit == "N"


@pytest.mark.parametrize(
    ("cfc", "peak", "b0", "a1", "a2"),
    [
        (60, 95.0788, 0.00145236747355, 1.88934322422, -0.895152694116),
        (180, 99.9655, 0.0117962710998, 1.67011746327, -0.717302547667),
        (600, None, 0.0971846252794, 0.945574009062, -0.334312510179),
        (1000, None, 0.219231417219, 0.311896544996, -0.188822213872),
    ],
)
def test_the_filter_is_that_of_j211(
    cfc: int, peak: float | None, b0: float, a1: float, a2: float
) -> None:
    """I6 by the recursion of the standard, written out, on noise; I8 on a half sine of 10 ms."""
    pytest.importorskip("scipy")
    noise = np.random.default_rng(3).normal(size=2000)
    noise[:300] = noise[-300:] = 0.0
    time = np.arange(2000) * 1e-4

    def once(x: np.ndarray) -> np.ndarray:
        y = np.zeros_like(x)
        for i in range(2, len(x)):
            y[i] = b0 * (x[i] + 2 * x[i - 1] + x[i - 2]) + a1 * y[i - 1] + a2 * y[i - 2]
        return y

    twice = once(once(noise)[::-1])[::-1]
    filtered = evaluate(f"cfc(a.b.c, {cfc})", lambda _: Series(time, noise, "m/s^2")).values
    # coefficients have 12 digits, and what is left of the past 30 ms ago is less
    np.testing.assert_allclose(filtered, twice, atol=1e-9 if cfc > 60 else 1e-4)
    if peak is not None:
        top = measured(f"cfc(a.b.c, {cfc})", "half sine", 100, 0.01, 1e-4, "max")
        assert top / G == pytest.approx(peak, abs=6e-5)


def test_a_filter_leaves_a_constant_and_a_slow_ramp_alone_up_to_the_ends() -> None:
    pytest.importorskip("scipy")
    time = np.arange(1000) * 1e-4
    for values in (np.full(1000, 7.0), 3.0 + 20.0 * time):
        filtered = evaluate("cfc(a.b.c, 180)", lambda _, v=values: Series(time, v, "N")).values
        # of a ramp's transient two periods of the corner leave e^(-2 pi sqrt(2)), squared
        np.testing.assert_allclose(filtered, values, rtol=1e-6)


def test_a_filter_takes_further_samples_between_even_ones() -> None:
    """A deck that asks for moments samples them too: the filtered curve stays what it is."""
    pytest.importorskip("scipy")
    even = np.arange(1001) * 1e-4

    def history(time: np.ndarray) -> Series:
        return Series(time, np.sin(2 * np.pi * 40 * time), "N")

    plain = evaluate("cfc(a.b.c, 180)", lambda _: history(even))
    uneven = np.sort(np.concatenate([even, [0.0123456, 0.05000001, 0.08765]]))
    filtered = evaluate("cfc(a.b.c, 180)", lambda _: history(uneven))
    np.testing.assert_allclose(np.interp(even, uneven, filtered.values), plain.values, atol=1e-9)


@pytest.mark.parametrize(
    ("expression", "unit", "words"),
    [
        (
            "cfc(a.b.c, 1000)",
            "N",
            "every 0.1 ms or more often, not every 0.2 ms: give output.history",
        ),
        ("cfc(a.b.c, 100)", "N", "classes 60, 180, 600, 1000"),
        ("cfc(a.b.c, '60 Hz')", "N", "classes 60, 180, 600, 1000"),
        ("cfc(a.b.c)", "N", "cfc(x, cfc) takes 2 to 2 values, not 1"),
        ("si(a.b.c)", "N", "si() takes an acceleration, not 'N'"),
        ("hic(a.b.c / a.b.c, '15 ms')", "N", "takes an acceleration"),
        ("hic(a.b.c, 15)", "m/s^2", "a duration with its unit, as in '15 ms'"),
        ("hic(a.b.c, '15 mm')", "m/s^2", "a duration with its unit"),
        ("hic(a.b.c, '-15 ms')", "m/s^2", "a duration with its unit"),
        ("hic(a.b.c, '15 furlongs')", "m/s^2", "unknown unit 'furlongs'"),
        ("clip(a.b.c, '3 s')", "m/s^2", "needs a history of 3000 ms"),
        ("envelope(a.b.c, a.b.c)", "s", "a duration with its unit"),
        ("resultant(a.b.c, time)", "m/s^2", "cannot add 'm/s^2' and 's'"),
        ("a.b.c - '54 km/h'", "N", "cannot add 'N' and 'm/s'"),
        ("mean(a.b.c)", "N", "unknown function 'mean'"),
    ],
)
def test_what_has_no_meaning_is_refused(expression: str, unit: str, words: str) -> None:
    time = np.arange(500) * 2e-4

    def lookup(name: str) -> Series:
        return Series(time, 1.0 + time, "s" if name == "time" else unit)

    with pytest.raises(ChannelError) as refusal:
        evaluate(expression, lookup)
    assert words in str(refusal.value)


def test_quantities_stand_for_their_si_values() -> None:
    time = np.arange(5.0)
    speed = Series(time, 15.0 + time, "m/s")
    series = evaluate("a.b.c - '54 km/h'", lambda _: speed)
    np.testing.assert_allclose(series.values, time, atol=1e-13)
    assert series.unit == "m/s"
    brake = evaluate("a.b.c / '2 g0'", lambda _: Series(time, 4 * G + 0 * time, "m/s^2"))
    assert (brake.values[0], brake.unit) == (pytest.approx(2.0), "")


@pytest.mark.skipif(not NHTSA.is_dir(), reason="the raw channels are not beside this copy")
@pytest.mark.parametrize(
    ("numbers", "header", "window", "hic15", "hic36", "index"),
    [
        # header: HIC of 15 ms and its window after CFC 1000; then I3 of our own filter
        ((1, 2, 3), 140, (0.0777, 0.0927), 139.798, 268.362, 369.83),
        ((47, 48, 49), 335, (0.0678, 0.0828), 334.922, 547.828, 683.38),
    ],
    ids=["driver", "passenger"],
)
def test_the_head_channels_of_a_crash_test_give_the_values_of_its_header(
    numbers: tuple[int, ...],
    header: int,
    window: tuple[float, float],
    hic15: float,
    hic36: float,
    index: float,
) -> None:
    pytest.importorskip("scipy")
    read = [np.loadtxt(NHTSA / f"v10146.{number:03d}") for number in numbers]
    channels = dict(zip(("head.a.x", "head.a.y", "head.a.z"), read, strict=True))

    def lookup(name: str) -> Series:
        return Series(channels[name][:, 0], channels[name][:, 1], "g0")

    filtered = ", ".join(f"cfc({name}, 1000)" for name in channels)

    def value(measure: str) -> float:
        return statistic(
            evaluate(measure.replace("HEAD", f"resultant({filtered})"), lookup), "final"
        )

    assert round(value("hic(HEAD, '15 ms')")) == header
    assert value("hic(HEAD, '15 ms')") == pytest.approx(hic15, abs=1e-3)
    assert value("hic(HEAD, '36 ms')") == pytest.approx(hic36, abs=1e-3)
    # the header gives its window to 0.1 ms, and may count the sample before or after
    window_of_channels = value("hic_start(HEAD, '15 ms')"), value("hic_end(HEAD, '15 ms')")
    np.testing.assert_allclose(window_of_channels, window, atol=1.01e-4)
    # from the first contact of the car on
    history = evaluate(f"si(resultant({filtered}))", lookup)
    before = float(np.interp(0.0, history.time, history.values))
    assert history.values[-1] - before == pytest.approx(index, abs=0.01)
