"""Claim: a film shows the largest contact force, and a picture beside it states how far it lies."""

from pathlib import Path

import numpy as np
import pytest
from small_results import write_result, write_status
from test_odd_scenes import GROUNDS, drawn_run

from crashpost.renders.appearance import Appearance
from crashpost.renders.drawing import Scene
from crashpost.renders.painting import clock
from crashpost.renders.tasks import film_task, strip_task
from crashpost.results.result import Result
from crashpost.results.states import States
from crashpost.values.summary import peaks


@pytest.fixture
def struck(tmp_path: Path) -> Result:
    """States at 0, 100 and 200 ms; a force that is largest at 104 ms."""
    drawn_run(tmp_path, None, (0.1, 1.0))
    time = np.linspace(0.0, 0.2, 51)
    force = np.maximum(1e3 - 5e4 * np.abs(time - 0.104), 0.0)[:, None]
    touch = np.where(time < 0.09, -1.0, 0.09)[:, None]
    channels = {"normal": ("N", "", force), "first_touch": ("s", "", touch)}
    (tmp_path / "history.h5").unlink()
    write_result(tmp_path, {"rcforc": (["hit"], channels)}, time)
    write_status(tmp_path)
    return Result(tmp_path)


def test_a_film_has_the_state_of_the_largest_force(struck: Result) -> None:
    """Frames every 13.3 ms, of which none meets the state at 100 ms by itself."""
    film = {"slow": 3.0, "fps": 25.0}
    shown = film_task(struck, Path("x.mp4"), "", arrows="rcforc", **film).frames
    assert (1.0, "t = 100 ms") in shown
    without = film_task(struck, Path("x.mp4"), "", **film).frames
    assert len(without) == len(shown) and (1.0, "t = 100 ms") not in without


def test_a_picture_states_how_far_its_peak_lies(struck: Result) -> None:
    task = strip_task(struck, Path("x.png"), ["max:rcforc.hit.normal", "0.1"], "")
    captions = [caption for _, caption in task.frames]
    assert captions == ["t = 100 ms\nlargest rcforc.hit.normal\nis 4 ms later", "t = 100 ms"]


def test_times_of_pictures_are_in_the_unit_of_the_page(struck: Result) -> None:
    task = strip_task(struck, Path("x.png"), ["0.1"], "", time_unit="s")
    assert task.frames[0][1] == "t = 0.100 s" == clock(0.1, 0.2, "s")


def test_a_moment_that_has_not_been_is_no_peak(struck: Result) -> None:
    assert [peak.channel for peak in peaks(struck)] == ["rcforc.hit.normal"]


@pytest.mark.parametrize("ground", ["box", "plane"])
def test_solids_of_the_ground_are_shaded_and_planes_are_not(ground: str, tmp_path: Path) -> None:
    drawn_run(tmp_path, GROUNDS[ground], (0.1, 1.0))
    scene = Scene(States(tmp_path), Appearance(show=(), color="", arrows=""))
    flat = [one.is_flat for one in scene.at(0).surfaces if "#d8d3c8" in one.colours]
    assert flat == [ground == "plane"]
