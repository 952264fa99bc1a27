"""Claim: samples follow a blow on an accelerometer that has a role, whatever their interval."""

from pathlib import Path

import pytest
from command import crashsolve

from crashpost.results.result import Result

DECK = Path(__file__).parents[2] / "decks" / "tutorial" / "head_form.yaml"
SEVERITY = "si(nodout.gauge.resultant)"
# of a half sine of 1 s and 1 g
HALF_SINE = 0.4576558581


def run(
    folder: Path, pulse: float, interval: float, *settings: str, words: tuple[str, ...] = ()
) -> Result:
    """A half sine of 100 g, from a flight of 20 ms on, in 50 steps."""
    given = [f"pulse={pulse} s", f"control.step={pulse / 50} s", "control.estimate=off"]
    given += [f"output.history.interval={interval} s", *settings]
    deck = folder.parent / "deck.yaml"
    # what it expects is of its own pulse and samples
    deck.write_text(DECK.read_text("utf-8").partition("expect:")[0], "utf-8")
    done = crashsolve(deck, "-o", folder, *(x for word in given for x in ("--set", word)), *words)
    assert done.returncode == 0, done.stderr
    return Result(folder)


@pytest.mark.parametrize("start", [0.02, 0.0203, 0.02049, 0.021])
@pytest.mark.parametrize("interval", [2.5e-4, 5e-4, 1e-3, 3e-3])
def test_the_index_of_a_blow_of_a_millisecond_is_that_of_any_samples(
    interval: float, start: float, tmp_path: Path
) -> None:
    result = run(tmp_path / "out", 1e-3, interval, f"flight={start} s")
    # (pi h / T)^2 / 24 of the peak and trapezoids, 2.5 times each: 0.2 %; 0.5 % where only every
    # step of the intervals that it touches is a sample
    assert result.value(SEVERITY, "final") == pytest.approx(HALF_SINE * 1e5 * 1e-3, rel=0.01)
    # two intervals, and one as the pulse begins and ends, in steps of a fiftieth of the pulse
    assert len(result.time) < 0.05 / interval + 4 * max(interval / 2e-5, 25)


def test_a_slow_pulse_needs_no_further_samples(tmp_path: Path) -> None:
    # a half wave of 40 intervals
    result = run(tmp_path / "out", 20e-3, 5e-4)
    # one interval as it begins, of at most 25 steps
    assert len(result.time) <= 101 + 25
    assert result.value(SEVERITY, "final") == pytest.approx(HALF_SINE * 1e5 * 20e-3, rel=0.01)


def test_samples_of_a_blow_survive_a_restart(tmp_path: Path) -> None:
    whole = run(tmp_path / "whole", 1e-3, 5e-4)
    dumps = "output.restart.every=10.2 ms"
    run(tmp_path / "parts", 1e-3, 5e-4, dumps, "control.end_time=20.4 ms")
    words = ("--restart", "--until", "0.05")
    parts = run(tmp_path / "parts", 1e-3, 5e-4, dumps, words=words)
    # the end of the first part is a sample of its own, and begins an interval
    assert len(parts.time) == pytest.approx(len(whole.time), abs=25)
    assert parts.value(SEVERITY, "final") == pytest.approx(whole.value(SEVERITY, "final"), rel=5e-3)


def test_an_index_that_samples_do_not_give_is_reported(tmp_path: Path) -> None:
    # steps of half of the pulse are all that could be samples
    result = run(tmp_path / "out", 1e-3, 5e-4, "control.step=0.5 ms", "control.energy_limit=10")
    assert "sensor 'gauge': its Severity Index is" in result.log
    (words,) = result.status["severity"]
    assert words.startswith("gauge ") and "+-" in words
    assert result.status["unfiltered"] == ["CFC 1000 needs 0.1 ms: gauge"]
    fine = run(tmp_path / "fine", 1e-3, 1e-4)
    assert "warning" not in fine.log and fine.status["unfiltered"] == []
    value, error = map(float, fine.status["severity"][0].removeprefix("gauge ").split(" +- "))
    exact = HALF_SINE * 1e5 * 1e-3
    # ten intervals in the pulse, as coarse as its corners are sampled, and three times the error
    assert value == pytest.approx(exact, rel=0.01) and error < 0.04 * exact
