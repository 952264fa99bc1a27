"""States: the index refers to what is there, and a restart takes the thread up again."""

import os
import random
import signal
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import h5py
import numpy as np
import pytest

from crashsolve.output import shapes
from crashsolve.output.blocks import Block, FieldSpec
from crashsolve.output.errors import OutputError
from crashsolve.output.states import StateWriter

FORCE = FieldSpec("force", "N", 3, "node")
STRAIN = FieldSpec("plastic_strain", "", 1, "cell")
GHOST = FieldSpec("vtkGhostType", "", 1, "cell")
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
BALL, BALL_TRIANGLES = shapes.sphere(1.0)
BLOCKS = (
    Block("ball", BALL, (("triangle", BALL_TRIANGLES),), (STRAIN,)),
    Block("contact points", np.zeros((4, 3)), (("vertex", np.arange(4)[:, None]),), (FORCE,)),
    Block(
        "shell",
        SQUARE,
        (
            ("quad", np.array([[0, 1, 2, 3]])),
            ("triangle", np.array([[1, 4, 2]])),
            ("line", np.array([[0, 4]])),
        ),
        (GHOST, STRAIN),
    ),
)


def values(time: float) -> dict[str, dict[str, np.ndarray]]:
    """Every field of every block filled with the time."""
    return {
        block.name: {field.name: np.full(block.shape(field), time) for field in block.all_fields}
        for block in BLOCKS
    }


def written(folder: Path, times: list[float], resume_time: float | None = None) -> StateWriter:
    """Write states and close."""
    writer = StateWriter(folder, BLOCKS, {"deck_text": "a: 1"}, resume_time)
    for moment in times:
        writer.write(moment, values(moment))
    writer.close()
    return writer


def references(folder: Path) -> list[ElementTree.Element]:
    """All references of the index to datasets."""
    return list(ElementTree.parse(folder / "states.xdmf").getroot().iter("DataItem"))


def index_times(folder: Path) -> list[list[float]]:
    """Times of each block's temporal collection."""
    root = ElementTree.parse(folder / "states.xdmf").getroot()
    return [
        [float(moment.attrib["Value"]) for moment in collection.iter("Time")]
        for collection in root.findall("Domain/Grid")
    ]


def test_every_reference_of_the_index_has_the_stated_shape(tmp_path: Path) -> None:
    written(tmp_path, [0.0, 0.1, 0.2])
    items = references(tmp_path)
    # three times; points, cells and displacement of each block, and four other fields
    assert len(items) == 3 * (3 * 3 + 4)
    types = {
        ("Float", "8"): "<f8",
        ("Float", "4"): "<f4",
        ("Int", "8"): "<i8",
        ("UChar", "1"): "u1",
    }
    for item in items:
        file, path = str(item.text).split(":")
        with h5py.File(tmp_path / file) as opened:
            dataset = opened[path]
            assert dataset.shape == tuple(map(int, item.attrib["Dimensions"].split()))
            kind = (item.attrib["NumberType"], item.attrib["Precision"])
            assert dataset.dtype == np.dtype(types[kind])


def test_states_hold_fields_units_and_time(tmp_path: Path) -> None:
    written(tmp_path, [0.0, 0.25])
    with h5py.File(tmp_path / "states" / "000001.h5") as file:
        assert file.attrs["time"] == 0.25
        assert file["contact points/force"].attrs["unit"] == "N"
        np.testing.assert_array_equal(file["ball/displacement"], np.full((len(BALL), 3), 0.25))
    with h5py.File(tmp_path / "mesh.h5") as file:
        assert file.attrs["format"] == "crashsolve states"
        np.testing.assert_array_equal(file["ball/points"], BALL)
        # quad is 5, triangle 4, a line 2 followed by its number of corners
        assert list(file["shell/cells"]) == [5, 0, 1, 2, 3, 4, 1, 4, 2, 2, 2, 0, 4]


def test_index_is_complete_after_close_and_whole_before(tmp_path: Path) -> None:
    writer = StateWriter(tmp_path, BLOCKS, {})
    for number in range(20):
        writer.write(float(number), values(0.0))
        for times in index_times(tmp_path):
            assert times == [float(earlier) for earlier in range(len(times))]
    writer.close()
    assert index_times(tmp_path) == [list(map(float, range(20)))] * len(BLOCKS)


@pytest.mark.long
def test_kill_at_random_moments_leaves_a_true_index(tmp_path: Path) -> None:
    dice = random.Random(7)
    seen = 0
    for attempt in range(40):
        child = os.fork()
        if child == 0:
            written(tmp_path, [0.1 * number for number in range(1000)])
            os._exit(0)
        # longer from try to try: a busy machine may take long to start the child
        time.sleep(dice.uniform(0.05, 0.1) * (1 + attempt / 4))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        if not (tmp_path / "states.xdmf").exists():
            continue
        for name in {str(item.text).split(":")[0] for item in references(tmp_path)}:
            with h5py.File(tmp_path / name) as file:
                assert "ball" in file
        seen += 1
        if seen == 15:
            break
    assert seen, "no run lived long enough to write an index"
    resumed = written(tmp_path, [], resume_time=1e9)
    assert resumed.times == [0.1 * number for number in range(len(resumed.times))]


def test_resume_keeps_earlier_states_and_drops_later_ones(tmp_path: Path) -> None:
    written(tmp_path, [0.0, 0.1, 0.2, 0.3])
    writer = written(tmp_path, [0.15], resume_time=0.1)
    assert writer.times == [0.0, 0.1, 0.15]
    assert index_times(tmp_path)[0] == [0.0, 0.1, 0.15]
    assert sorted(path.name for path in (tmp_path / "states").iterdir()) == [
        "000000.h5",
        "000001.h5",
        "000002.h5",
    ]


def test_fresh_run_drops_the_states_of_the_last_one(tmp_path: Path) -> None:
    written(tmp_path, [0.0, 0.1, 0.2])
    written(tmp_path, [0.0])
    assert index_times(tmp_path)[0] == [0.0]
    assert len(list((tmp_path / "states").iterdir())) == 1


def test_the_index_drops_states_before_their_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path, [0.0, 0.1, 0.2])

    def killed(path: Path, missing_ok: bool = False) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "unlink", killed)
    with pytest.raises(KeyboardInterrupt):
        StateWriter(tmp_path, BLOCKS, {}, resume_time=0.1)
    assert index_times(tmp_path)[0] == [0.0, 0.1]


def test_there_is_no_index_without_states(tmp_path: Path) -> None:
    written(tmp_path, [0.0])
    written(tmp_path, [])
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "mesh.h5",
        "states",
        "view_in_paraview.py",
    ]


def test_gap_among_the_states_is_reported(tmp_path: Path) -> None:
    written(tmp_path, [0.0, 0.1, 0.2])
    (tmp_path / "states" / "000001.h5").unlink()
    with pytest.raises(OutputError, match=r"000002\.h5: the state before this one is missing"):
        written(tmp_path, [], resume_time=0.2)


def test_wrong_shape_is_refused_and_leaves_no_state(tmp_path: Path) -> None:
    writer = StateWriter(tmp_path, BLOCKS, {})
    broken = values(0.0)
    broken["shell"]["plastic_strain"] = np.zeros(2)
    with pytest.raises(ValueError, match="shell, plastic_strain"):
        writer.write(0.0, broken)
    assert list((tmp_path / "states").iterdir()) == []


@pytest.mark.parametrize(
    ("name", "points", "cells"),
    [
        ("empty", np.zeros((0, 3)), (("vertex", np.zeros((0, 1), int)),)),
        ("a/b", SQUARE, (("vertex", np.array([[0]])),)),
        ("flat", SQUARE[:, :2], (("vertex", np.array([[0]])),)),
        ("corner", SQUARE, (("triangle", np.array([[0, 1, 5]])),)),
        ("width", SQUARE, (("quad", np.array([[0, 1, 2]])),)),
    ],
)
def test_block_no_reader_could_open_is_refused(
    name: str, points: np.ndarray, cells: tuple[tuple[str, np.ndarray], ...]
) -> None:
    with pytest.raises(ValueError, match=name):
        Block(name, points, cells)
