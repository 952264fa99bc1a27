"""Claim: the largest contact force that is reported is that of all steps, not of the samples."""

from pathlib import Path

import numpy as np
from small_results import write_result, write_status

from crashpost.results.result import Result
from crashpost.values.events import events


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
