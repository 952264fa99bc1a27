"""Claim: valid HDF5 of wrong shapes and types ends in one message, never in a traceback."""

import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from command import crashsolve

from crashpost import cli
from crashpost.renders import painting

sys.path.insert(0, str(Path(__file__).parents[1] / "postproc"))
from damage import damages
from quick import first_quick
from small_results import two_cars, write_result, write_status
from test_renders import write_states

# every damage takes a tenth of a second; this many are spread over each file
EACH = 12
# runs that go on take longer
AGAIN = 3
OSCILLATOR = Path(__file__).parents[1] / "runs" / "oscillator.yaml"
SHORT = ("--set", "control.end_time=0.02", "--set", "control.estimate=off")
SHORT += ("--set", "output.restart.every=0.005")


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    folder = write_result(tmp_path / "whole.results", two_cars(), title="cars \\mu $1")
    write_status(folder)
    return write_states(folder)


@pytest.mark.parametrize("name", first_quick(["mesh.h5", "states/000001.h5", "history.h5"]))
def test_damaged_results_are_drawn_or_refused(
    whole: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the plain painter, in this process
    monkeypatch.setattr(painting, "_in_child", lambda *_: "in this process")
    every = list(damages(whole / name))
    assert len(every) > 3 * EACH
    questions = tmp_path / "questions.json"
    questions.write_text('[{"channel": "glstat.model.energy.kinetic", "statistic": "max"}]')
    for k, (word, deed) in enumerate(every[:: len(every) // EACH]):
        folder = tmp_path / f"{k}.results"
        shutil.copytree(whole, folder)
        with h5py.File(folder / name, "r+") as file:
            deed(file)
        for command in (["render", "-o", "x.png"], ["pack", "-o", "x.vtkhdf"], ["summary"]):
            output = [str(folder / w) if w.startswith("x.") else w for w in command[1:]]
            assert cli.main([command[0], str(folder), *output]) in (0, 2), word
        if name == "history.h5":
            assert cli.main(["channels", str(folder)]) in (0, 2), word
            assert cli.main(["values", str(folder), str(questions)]) in (0, 2), word


@pytest.mark.long
@pytest.mark.parametrize("name", ["mesh.h5", "states/000001.h5", "history.h5"])
def test_damaged_results_are_reported_or_refused(
    whole: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(painting, "_in_child", lambda *_: "in this process")
    every = list(damages(whole / name))
    for k, (word, deed) in enumerate(every[:: len(every) // EACH]):
        folder = tmp_path / f"{k}.results"
        shutil.copytree(whole, folder)
        with h5py.File(folder / name, "r+") as file:
            deed(file)
        assert cli.main(["report", str(folder), "-o", str(folder / "x.html")]) in (0, 2), word


# of results that a run goes on with
KEPT = ("history.h5", "restart_0.h5", "mesh.h5")


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of which the end comes later, with its dumps."""
    folder = tmp_path_factory.mktemp("stopped") / "results"
    done = crashsolve(OSCILLATOR, "-o", folder, *SHORT, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("name", KEPT)
def test_a_restart_with_damaged_results_continues_or_names_the_damage(
    stopped: Path, name: str, tmp_path: Path
) -> None:
    every = list(damages(stopped / name))
    names = [path.name for path in stopped.glob("restart_*.h5")] if name == KEPT[1] else [name]
    for k, (word, deed) in enumerate(every[:: len(every) // AGAIN]):
        folder = tmp_path / str(k)
        shutil.copytree(stopped, folder)
        for one in names:
            with h5py.File(folder / one, "r+") as file:
                deed(file)
        words = ("--restart", "--until", "0.03", *SHORT[2:])
        done = crashsolve(OSCILLATOR, "-o", folder, *words, CRASHSOLVE_PLAIN="1")
        assert done.returncode in (0, 2, 5), f"{word}: {done.stderr}"
        assert "Traceback" not in done.stdout + done.stderr, word


# a mistaken history that showed a traceback where a run went on with it
@pytest.mark.parametrize("wrong", [np.zeros((0, 1)), np.float64(3.0), np.zeros((5, 1, 1))])
def test_a_restart_names_a_history_of_other_shapes(
    stopped: Path, wrong: np.ndarray, tmp_path: Path
) -> None:
    folder = tmp_path / "results"
    shutil.copytree(stopped, folder)
    with h5py.File(folder / "history.h5", "r+") as file:
        del file["glstat/energy/kinetic"]
        file["glstat/energy/kinetic"] = wrong
    words = ("--restart", "--until", "0.03", *SHORT[2:])
    done = crashsolve(OSCILLATOR, "-o", folder, *words, CRASHSOLVE_PLAIN="1")
    assert done.returncode == 5
    assert "history.h5: glstat/energy/kinetic is no table of a number for each time" in done.stderr


def test_a_history_without_groups_has_no_channels(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_result(tmp_path, {})
    assert cli.main(["channels", str(tmp_path)]) == 0
    assert "channel" in capsys.readouterr().out


@pytest.mark.parametrize("missing", ["part", "section", "side", "links"])
def test_blocks_without_what_a_drawing_needs_are_refused(
    whole: Path, missing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with h5py.File(whole / "mesh.h5", "r+") as file:
        beams = {"part": np.zeros(1), "section": np.zeros(1), "side": np.ones((1, 3))}
        name = "links" if missing == "links" else "beams"
        file[f"{name}/points"], file[f"{name}/cells"] = np.eye(3)[:2], np.array([[0, 1]])
        for key in beams.keys() - {missing} if name == "beams" else ():
            file[f"beams/{key}"] = beams[key]
    assert cli.main(["render", str(whole), "-o", str(whole / "x.png")]) == 2
    wanted = "links has no body" if missing == "links" else f"beams has no {missing}"
    assert wanted in capsys.readouterr().err


def test_a_state_without_its_forces_is_refused(
    whole: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(painting, "_in_child", lambda *_: "in this process")
    with h5py.File(whole / "states" / "000001.h5", "r+") as file:
        del file["contacts"]
        file["contacts"] = np.zeros(3)
    command = ["render", str(whole), "--arrows", "rcforc", "-o", str(whole / "x.png")]
    assert cli.main(command) == 2
    assert "contacts has no field 'force'" in capsys.readouterr().err
