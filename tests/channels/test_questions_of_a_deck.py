"""Claim: what a deck asks of its channels is tried before it runs; no answer is guessed."""

from pathlib import Path

import pytest
from command import crashsolve

from crashsolve.deck.reading.deck import read_deck
from crashsolve.foundation.errors import DeckError
from crashsolve.study.watch import watched

FLIGHT = """
control: {end_time: 1, step: 0.01}
output: {history: {interval: 0.01}}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], velocity: [3, 0, 0]}}
"""


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    path = tmp_path / "flight.yaml"
    path.write_text(FLIGHT + "watch: [{channel: rbdout.ball.position.x, statistic: at:0.333}]\n")
    return path


def test_questions_that_make_no_sense_are_refused_before_the_run(flight: Path) -> None:
    wrong = {
        "cfc(rbdout.ball.velocity.x, 60)": "cfc(..., 60) needs samples every 1.667 ms or more "
        "often, not every 10 ms: give output.history.interval 1.667 ms or less",
        "rbdout.ball.velocity.x + rbdout.ball.position.x": "cannot add 'm/s' and 'm'",
        "hic(rbdout.ball.velocity.x, '15 ms')": "hic() takes an acceleration, not 'm/s'",
        "sin(rbdout.ball.velocity.x)": "unknown function 'sin'",
        "rbdout.ball.velocity.x at:0.5": "cannot read the expression 'rbdout.ball.velocity.x "
        "at:0.5'; a statistic is a field of its own: {channel: rbdout.ball.velocity.x, "
        "statistic: at:0.5}",
    }
    entries = [f'{{channel: "{channel}", statistic: max}}' for channel in wrong]
    entries += ["{channel: rbdout.ball.velocity.x, statistic: at:-0.1}"]
    flight.write_text(f"{FLIGHT}watch: [{', '.join(entries)}]\n")
    done = crashsolve(flight, "-o", flight.parent / "results", CRASHSOLVE_PLAIN="1")
    *lines, last = done.stderr.splitlines()
    assert (done.returncode, len(lines)) == (2, len(wrong)), done.stderr
    for number, (line, reported) in enumerate(zip(lines, wrong.values(), strict=True), 1):
        assert "flight.yaml:5:" in line and f"watch {number}: channel: {reported}" in line
    assert "watch 6: statistic: 'at:-0.1' is before the run, from 0 s on" in last


def test_a_value_in_a_unit_that_its_statistic_cannot_have_is_refused(flight: Path) -> None:
    """Of a maximum the unit is that of the channel, of an integral that times seconds."""
    said = "because: exact, source: none, tolerance: 1 %"
    requested = [("max", "5 m"), ("max", "5 s"), ("integral", "5 m s"), ("integral", "5 m")]
    entries = [
        f"{{channel: rbdout.ball.position.x, statistic: {word}, value: {value}, {said}}}"
        for word, value in requested
    ]
    flight.write_text(f"{FLIGHT}expect: [{', '.join(entries)}]\n")
    done = crashsolve("check", flight)
    assert done.returncode == 2
    assert [line.partition("expect ")[2] for line in done.stderr.splitlines()] == [
        "2: value: is in s, but 'max' of the channel in m",
        "4: value: is in m, but 'integral' of the channel in m s",
    ]


def test_a_study_refuses_a_moment_that_no_run_samples(flight: Path) -> None:
    deck = read_deck(flight)
    channel = "rbdout.ball.position.x"
    # a multiple of the interval, and one that the deck watches
    for moment in ("0.25", "0.333"):
        (watch,) = watched(deck, [f"{channel}:at:{moment}"])
        assert watch.statistic == f"at:{moment}"
    with pytest.raises(DeckError) as refusal:
        watched(deck, [f"{channel}:at:0.3335"])
    assert "the runs have no sample at 0.3335 s" in str(refusal.value)
    assert f'watch: [{{channel: "{channel}", statistic: at:0.3335}}]' in str(refusal.value)
