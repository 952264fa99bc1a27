"""A step that fails among samples of compiled code leaves those before it, and its message."""

from pathlib import Path

from command import crashsolve

from crashpost.results.result import Result

DECK = Path(__file__).parents[2] / "decks" / "extreme" / "cone_poles.yaml"


def test_samples_before_a_step_that_fails_are_written(tmp_path: Path) -> None:
    # the rod comes to 3 rad, which the stop refuses, at 0.5 s; a sample is every 3.4 ms
    words = ("--set", "control.estimate=off", "--set", "half=2.9")
    done = crashsolve(DECK, "-o", tmp_path / "out", *words)
    assert done.returncode == 4, done.stderr
    assert "its joint has swung by 3 rad" in done.stderr and "Traceback" not in done.stderr
    swing = Result(tmp_path / "out").series("deforc.cone.swing")
    assert swing.time[-1] > 0.49 and swing.values[-1] > 2.9
