"""Claim: valid HDF5 of wrong shapes and types ends in one message, never in a traceback."""

import shutil
import sys
from pathlib import Path

import h5py
import pytest

from crashpost import cli
from crashpost.renders import studio

sys.path.insert(0, str(Path(__file__).parents[1] / "postproc"))
from damage import damages
from small_results import two_cars, write_result, write_status
from test_renders import write_states

# every damage takes a tenth of a second; this many are spread over each file
EACH = 12


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    folder = write_result(tmp_path / "whole.results", two_cars(), title="cars \\mu $1")
    write_status(folder)
    return write_states(folder)


@pytest.mark.parametrize("name", ["mesh.h5", "states/000001.h5", "history.h5"])
def test_damaged_results_are_drawn_or_refused(
    whole: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the plain painter, in this process
    monkeypatch.setattr(studio, "_in_child", lambda *_: "in this process")
    every = list(damages(whole / name))
    assert len(every) > 3 * EACH
    for k, (word, deed) in enumerate(every[:: len(every) // EACH]):
        folder = tmp_path / f"{k}.results"
        shutil.copytree(whole, folder)
        with h5py.File(folder / name, "r+") as file:
            deed(file)
        for command in (["render", "-o", "x.png"], ["pack", "-o", "x.vtkhdf"], ["summary"]):
            output = [str(folder / w) if w.startswith("x.") else w for w in command[1:]]
            assert cli.main([command[0], str(folder), *output]) in (0, 2), word


def test_a_history_without_groups_has_no_channels(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_result(tmp_path, {})
    assert cli.main(["channels", str(tmp_path)]) == 0
    assert "channel" in capsys.readouterr().out
