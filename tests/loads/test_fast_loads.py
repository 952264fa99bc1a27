"""Loads that change faster than samples: their impulse is found, or its error is reported.

A force on a free body of 1 kg gives it the velocity that is the integral of the force: of
1 - cos(2 pi f t) over whole periods the time, of a Gaussian pulse of width w its area sqrt(pi) w.
"""

from math import acos, cos, exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve
from quick import first_quick

from crashpost.results.result import Result
from crashsolve.deck.reading.deck import read_deck
from crashsolve.estimate.estimator import estimate_in_memory
from crashsolve.model.build import build
from crashsolve.model.curve_steps import PER_PERIOD, steps_by_curves

METHODS = (
    "rattle",
    "dormand_prince_5",
    "dormand_prince_8",
    "generalized_alpha",
    "radau_iia_5",
)
# beside an error of the order that is reported: what the cubics of a formula miss of it
CUBICS = 1e-9


def deck(folder: Path, formulas: list[str], end: float, control: str = "", out: str = "") -> Path:
    path = folder / "deck.yaml"
    curves = "\n".join(
        f"  p{k}: {{type: formula, expression: '{text}', from: 0, to: {end}}}"
        for k, text in enumerate(formulas)
    )
    loads = "\n".join(
        f"  f{k}: {{type: force, body: m, force: [1, 0, 0], curve: p{k}}}"
        for k in range(len(formulas))
    )
    path.write_text(
        f"control: {{end_time: {end}{control}}}\n{out}\n"
        "bodies:\n  m: {mass: 1, inertia: [1, 1, 1]}\n"
        f"curves:\n{curves}\nloads:\n{loads}\n"
        "watch: [{channel: rbdout.m.velocity.x, statistic: final}]\n"
    )
    return path


def check(path: Path, true: float, accuracy: float) -> None:
    """The value is right, and its error reported to a factor of ten."""
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    assert estimated.value is not None and estimated.error is not None
    off = abs(estimated.value - true)
    assert off <= accuracy * abs(true)
    assert off <= 10.0 * estimated.error + CUBICS * abs(true)


@pytest.mark.parametrize("frequency", [999, 1000, 20_000])
def test_a_load_of_the_frequency_of_the_samples_is_seen(frequency: int, tmp_path: Path) -> None:
    end = 100 / frequency
    interval = end / 100 if frequency != 999 else end / 97
    path = deck(
        tmp_path,
        [f"1 - cos(2*pi*{frequency}*x)"],
        end,
        out=f"output: {{history: {{interval: {interval!r}}}}}",
    )
    # trapezoids of 40 steps a period; those of unequal length miss some of a period's end
    check(path, end, 1e-4)


@pytest.mark.parametrize("method", first_quick(METHODS, 2))
@pytest.mark.parametrize("width", first_quick([1e-4, 2e-2]))
def test_a_pulse_between_two_samples_is_seen(method: str, width: float, tmp_path: Path) -> None:
    for middle in (0.1234, 0.375):
        path = deck(
            tmp_path,
            [f"1000*exp(-((x - {middle})/{width})**2)"],
            0.5,
            f", integrator: {method}",
            "output: {history: {interval: 0.05}}",
        )
        # 40 steps a period of a sine like the pulse, whose length changes over it
        check(path, 1000 * sqrt(pi) * width, 2e-3)


def test_several_fast_loads_at_once_are_seen(tmp_path: Path) -> None:
    formulas = ["1 - cos(2*pi*500*x)", "50*exp(-((x - 0.0333)/3e-4)**2)", "2 + sin(2*pi*2000*x)"]
    path = deck(tmp_path, formulas, 0.1, out="output: {history: {interval: 0.01}}")
    check(path, 0.1 + 50 * sqrt(pi) * 3e-4 + 0.2, 1e-3)


@pytest.mark.parametrize("step", [5e-4, 1e-3])
@pytest.mark.parametrize("method", ["rattle", "generalized_alpha", "dormand_prince_5"])
def test_a_stated_step_that_misses_a_load_states_so(
    step: float, method: str, tmp_path: Path
) -> None:
    control = f", step: {step}, integrator: {method}"
    path = deck(tmp_path, ["1 - cos(2*pi*1000*x)"], 0.1, control)
    model, _ = build(read_deck(path))
    assert any("points per period of curve 'p0'" in text for text in model.warnings)
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    assert estimated.value is not None and estimated.error is not None
    assert abs(estimated.value - 0.1) <= 2.0 * estimated.error + CUBICS


def test_a_stated_step_that_resolves_a_load_is_accepted(tmp_path: Path) -> None:
    # samples no nearer than the step, which they would cut
    out = "output: {history: {interval: 2e-4}}"
    path = deck(tmp_path, ["1 - cos(2*pi*100*x)"], 0.1, ", step: 2e-4", out=out)
    model, _ = build(read_deck(path))
    assert not model.warnings


@pytest.mark.parametrize("interpolation", ["smooth", "cubic"])
def test_a_table_is_seen_like_a_formula(interpolation: str, tmp_path: Path) -> None:
    times = np.linspace(0, 0.05, 501)
    points = [[float(t), 1 - cos(2 * pi * 1000 * t)] for t in times]
    path = deck(tmp_path, ["0*x"], 0.05, out="output: {history: {interval: 0.001}}")
    lines = path.read_text().replace("{type: formula, expression: '0*x', from: 0, to: 0.05}", "P")
    path.write_text(lines.replace("P", f"{{points: {points}, interpolation: {interpolation}}}"))
    # ten points a period, symmetric about its middle: any interpolation has its area, but at ends
    check_table(path, 0.05)


def check_table(path: Path, true: float) -> None:
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    assert estimated.value == pytest.approx(true, rel=1e-3)


def test_steps_are_short_where_the_curve_is_fast_alone(tmp_path: Path) -> None:
    frequency, width = 250.0, 1e-3
    model, _ = build(read_deck(deck(tmp_path, [f"sin(2*pi*{frequency}*x)"], 1)))
    _, steps = steps_by_curves(model)
    # parts of the curve need not hold a whole period
    assert steps[np.isfinite(steps)] == pytest.approx(1 / (PER_PERIOD * frequency), rel=0.2)
    model, _ = build(read_deck(deck(tmp_path, [f"exp(-((x - 0.4)/{width})**2)"], 1)))
    starts, steps = steps_by_curves(model)
    fast = starts[steps < width]
    # exp(-100) and less is nothing
    assert abs(fast - 0.4).max() < 12 * width


# rise and fall of a lone pulse [s]: shorter than the step that nothing bounds, and unlike, so that
# position and work depend on each; two companions had as many steps in the last
PULSES = [(1.8e-5, 1.3e-5), (1.4e-4, 2.5e-5), (1.2e-3, 1.5e-6)]


@pytest.mark.parametrize("method", ["rattle", "generalized_alpha"])
def test_a_lone_pulse_of_unlike_slopes_moves_a_body(method: str, tmp_path: Path) -> None:
    for k, (rise, fall) in enumerate(PULSES):
        out = f"output: {{history: {{interval: {(0.01, 4e-4, 0.05)[k]}}}}}"
        path = deck(tmp_path, ["0*x"], 0.1, f", integrator: {method}", out)
        start, top = 0.03, 0.03 + rise
        points = [[0, 0], [start, 0], [top, 1000], [top + fall, 0], [1, 0]]
        text = path.read_text().replace(
            "{type: formula, expression: '0*x', from: 0, to: 0.1}", f"{{points: {points}}}"
        )
        path.write_text(f"{text[:-2]}, {{channel: rbdout.m.position.x, statistic: final}}]\n")
        impulse = 500.0 * (rise + fall)
        # of the triangle: a third of the way from its top to the middle of its base
        centre = start + (2.0 * rise + fall) / 3.0
        _, estimates, _ = estimate_in_memory(read_deck(path))
        for estimate, true in zip(estimates, (impulse, impulse * (0.1 - centre)), strict=True):
            assert estimate.value is not None and estimate.error is not None
            off = abs(estimate.value - true)
            # 8 steps of order 2 in each slope
            assert off <= 2e-3 * true
            assert off <= 10.0 * estimate.error + CUBICS * true


def test_a_load_of_infinite_slope_takes_short_steps_there_alone(tmp_path: Path) -> None:
    path = deck(tmp_path, ["sqrt(x)"], 2)
    model, _ = build(read_deck(path))
    starts, steps = steps_by_curves(model)
    lengths = np.diff(np.r_[starts, 2.0])
    # by octaves towards 0, which take some ten steps each
    assert np.ceil(lengths / steps)[np.isfinite(steps)].sum() < 600
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    assert estimated.value is not None and estimated.error is not None
    assert abs(estimated.value - 2.0**2.5 / 3.0) <= 2.0 * estimated.error + CUBICS


@pytest.mark.parametrize("method", first_quick(METHODS, 2))
@pytest.mark.parametrize("level", first_quick([0.99, 0.8, 0.9999]))
def test_bursts_that_begin_and_end_with_a_kink_are_seen(
    method: str, level: float, tmp_path: Path
) -> None:
    rate, periods = 6000.0, 20
    end = periods * 2.0 * pi / rate
    # samples of which some lie in a burst, and most do not
    out = f"output: {{history: {{interval: {end / 190!r}}}}}"
    formula = f"1000*max(0, sin({rate}*x) - {level})"
    path = deck(tmp_path, [formula], end, f", integrator: {method}", out)
    model, _ = build(read_deck(path))
    starts, steps = steps_by_curves(model)
    lengths = np.diff(np.r_[starts, end])
    # parts between bursts have steps of neighbours; round-off at kinks made a million of them
    assert np.ceil(lengths / steps)[np.isfinite(steps)].sum() < 200 * periods
    # 16 steps a burst or more
    check(path, 2000 * periods / rate * (sqrt(1 - level**2) - level * acos(level)), 1.0 / 16**2)


@pytest.mark.parametrize("method", first_quick(METHODS, 1))
@pytest.mark.parametrize("start", [7.0, 58.0])
def test_a_motion_that_begins_from_almost_nothing_stops_no_method(
    method: str, start: float, tmp_path: Path
) -> None:
    width, height, rate = 0.03, 0.016, 30.0
    middle = start * width
    end = middle + 12 * width
    path = tmp_path / "deck.yaml"
    path.write_text(f"""
control: {{end_time: {end}, integrator: {method}}}
output: {{history: {{interval: {width / 10}}}}}
bodies: {{table: {{mass: 0.5, inertia: [1, 1, 1]}}, m: {{mass: 5, inertia: [1, 1, 1]}}}}
curves:
  p: {{type: formula, expression: '{height}*exp(-((x - {middle})/{width})**2)', from: 0, to: 9}}
joints:
  rail: {{type: prismatic, b: table, at: [0, 0, 0], axis: [1, 0, 0]}}
  drive: {{type: translation_driver, joint: rail, curve: p}}
springs: {{s: {{type: bushing, a: table, b: m, stiffness: [{5 * rate**2}, 1, 1]}}}}
watch: [{{channel: rbdout.m.position.x, statistic: final}}]
""")
    # an oscillator on a base that moves by a Gaussian: its convolution with omega sin(omega t)
    area = height * width * sqrt(pi) * exp(-((rate * width / 2.0) ** 2))
    # steps of 40 in a period of the pulse, of order 2 in some methods
    check(path, rate * area * sin(rate * (end - middle)), 2e-3)


@pytest.mark.parametrize("step", ["auto", "1e-3"])
def test_a_run_that_ends_on_a_short_ramp_estimates_what_moves_on_it(
    step: str, tmp_path: Path
) -> None:
    ramp = 1e-4
    path = deck(tmp_path, ["0*x"], 1, f", step: {step}", out="output: {history: {interval: 0.01}}")
    points = [[0, 0], [1 - ramp, 0], [1, 1], [2, 1]]
    text = path.read_text().replace(
        "{type: formula, expression: '0*x', from: 0, to: 1}", f"{{points: {points}}}"
    )
    path.write_text(text.replace("velocity.x", "position.x"))
    _, (estimated,), _ = estimate_in_memory(read_deck(path))
    assert estimated.value is not None and estimated.error is not None
    off = abs(estimated.value - ramp**2 / 6.0)
    # of order 2, with four steps over the ramp
    assert off < 0.07 * estimated.value and off <= 2.0 * estimated.error


@pytest.mark.parametrize("field", ["curve", "velocity", "acceleration"])
def test_what_the_cubics_of_a_formula_miss_is_in_the_error(field: str, tmp_path: Path) -> None:
    amplitude, omega, end = 0.1, 7.0, 0.9
    path, signs = (
        tmp_path / "deck.yaml",
        {"curve": "sin", "velocity": "cos", "acceleration": "-sin"},
    )
    k = ("curve", "velocity", "acceleration").index(field)
    path.write_text(
        f"control: {{end_time: {end}}}\n"
        f"bodies: {{m: {{mass: 2, inertia: [1, 1, 1], velocity: [{amplitude * omega}, 0, 0]}}}}\n"
        f"curves: {{p: {{type: formula, expression: '{amplitude * omega**k}"
        f"*({signs[field]}({omega}*x))', from: 0, to: 10}}}}\n"
        "joints:\n  rail: {type: prismatic, b: m, at: [0, 0, 0], axis: [1, 0, 0]}\n"
        f"  drive: {{type: translation_driver, joint: rail, {field}: p}}\n"
        "watch:\n- {channel: rbdout.m.position.x, statistic: final}\n"
        "- {channel: rbdout.m.velocity.x, statistic: final}\n"
        "- {channel: rbdout.m.acceleration.x, statistic: final}\n"
        "- {channel: jntforc.drive.force.x, statistic: final}\n"
    )
    where, rate = amplitude * np.sin(omega * end), amplitude * omega * np.cos(omega * end)
    true = [where, rate, -(omega**2) * where, -2.0 * omega**2 * where]
    _, estimates, _ = estimate_in_memory(read_deck(path))
    for estimate, exact in zip(estimates, true, strict=True):
        assert estimate.value is not None and estimate.error is not None
        # errors of an acceleration add up over its integrals
        assert abs(estimate.value - exact) <= 10.0 * estimate.error


@pytest.mark.parametrize("width", [1e-3, 1e-5])
def test_a_body_that_one_pulse_moves_and_another_stops_keeps_its_balance(
    width: float, tmp_path: Path
) -> None:
    # between two checks of the balance: at each of them there is no energy but round-off
    path = tmp_path / "deck.yaml"
    path.write_text(
        "control: {end_time: 1, estimate: off}\noutput: {history: {interval: 0.01}}\n"
        "bodies:\n  m: {mass: 1, inertia: [1, 1, 1]}\ncurves:\n"
        f"  p: {{points: [[0, 0], [0.503, 0], [{0.503 + width}, 1000], "
        f"[{0.503 + 3 * width}, -1000], [{0.503 + 4 * width}, 0], [2, 0]]}}\n"
        "loads:\n  f: {type: force, body: m, force: [1, 0, 0], curve: p}\n"
    )
    done = crashsolve(path, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    result = Result(tmp_path / "out")
    # in %: each straight piece of the curve takes eight steps
    assert result.value("glstat.model.balance", "abs_max") < 1.0
    assert abs(result.value("rbdout.m.velocity.x", "final")) < 1e-9 * 1000 * width
