"""Claim: the largest contact force reported is that of all steps, and no other event hides it."""

from pathlib import Path

import numpy as np
from small_results import write_result, write_status

from crashpost.results.result import Result
from crashpost.values.events import MAX_EVENTS, events


def reported(folder: Path, shown: list[float], of_steps: list[float]) -> list[str]:
    """Texts of the largest force of a contact with samples of every second."""
    forces = {
        "normal": ("N", "", np.array([shown], float).T),
        "peak_normal": ("N", "", np.array([of_steps], float).T),
    }
    write_result(folder, {"rcforc": (["wall"], forces)}, np.arange(float(len(shown))))
    write_status(folder)
    peaks = [e for e in events(Result(folder)) if "largest" in e.text]
    assert [e.time for e in peaks] == [2.0]
    return [e.text for e in peaks]


def test_a_peak_between_samples_is_that_of_the_steps(tmp_path: Path) -> None:
    (text,) = reported(tmp_path / "hidden", [0.0, 2e3, 4e3, 0.0], [0.0, 2e3, 5e3, 5e3])
    assert "5 kN" in text and "begins at 1 s" in text


def test_a_peak_that_a_sample_shows_has_its_time(tmp_path: Path) -> None:
    (text,) = reported(tmp_path / "shown", [0.0, 2e3, 5e3, 0.0], [0.0, 2e3, 5e3, 5e3])
    assert "5 kN" in text and "interval" not in text


def test_many_that_begin_to_yield_hide_no_contact(tmp_path: Path) -> None:
    """60 hinges yield before the force is largest: those of one sample are one event."""
    time = np.arange(100.0)
    names = [f"hinge_{k}" for k in range(60)]
    # ten together, then one by one, all before the peak
    begin = np.array([1] * 10 + list(range(2, 52)))
    plastic = (time[:, None] >= begin).astype(float)
    force = np.where(time == 80.0, 5e3, 0.0)[:, None]
    families = {
        "rcforc": (["wall"], {"normal": ("N", "", force), "peak_normal": ("N", "", force)}),
        "hinge": (names, {"plastic_angle": ("rad", "", plastic)}),
    }
    write_result(tmp_path, families, time)
    write_status(tmp_path)
    reported = events(Result(tmp_path))
    assert len(reported) == MAX_EVENTS
    assert reported[0].text == "Hinge 0 and 9 others begin to yield"
    assert reported[-2].text == "Wall: largest contact force, 5 kN"
    # 52 events, of which 39 have a line
    assert reported[-1].text == "13 more events are not listed here"
