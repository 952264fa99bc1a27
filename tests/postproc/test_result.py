"""Reading a results folder: whole, growing, broken or foreign."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from small_results import SPEED, TIME, two_cars, write_result, write_status

from crashpost.errors import PostError
from crashpost.results.result import Result
from crashsolve.channels.series import Series


def test_channels_carry_name_unit_meaning_and_sample_count(cars: Path) -> None:
    channels = {channel.name: channel for channel in Result(cars).channels()}
    assert len(channels) == 9
    force = channels["deforc.buffer.force"]
    assert (force.unit, force.meaning, force.samples) == ("N", "tension positive", len(TIME))


def test_a_pattern_selects_channels(cars: Path) -> None:
    names = [channel.name for channel in Result(cars).channels("rbdout.*.velocity.x")]
    assert names == ["rbdout.A.velocity.x", "rbdout.car-b.velocity.x"]


def test_series_are_the_stored_bits(cars: Path) -> None:
    time, values, unit = Result(cars).series("rbdout.car-b.velocity.x")
    stored = two_cars()["rbdout"][1]["velocity/x"][2]
    assert np.array_equal(time, TIME)
    assert np.array_equal(values, stored[:, 1])
    assert unit == "m/s"


def test_folder_and_file_open_the_same_result(cars: Path) -> None:
    assert Result(cars / "history.h5").title == Result(cars).title == "Two cars"


def test_reserved_rows_do_not_exist(tmp_path: Path) -> None:
    result = Result(write_result(tmp_path, two_cars(), reserved=600))
    assert len(result.time) == len(result.series("deforc.buffer.force").values) == len(TIME)
    assert result.series("rbdout.A.velocity.x").values[0] == SPEED


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("rbdot.A.velocity.x", "unknown family 'rbdot'; did you mean 'rbdout'?"),
        ("rbdout.car_b.velocity.x", "unknown rbdout entity 'car_b'; did you mean 'car-b'?"),
        ("rbdout.A.velocity", "unknown rbdout quantity 'velocity'; did you mean 'velocity.x'?"),
        ("rbdout", "unknown rbdout entity ''"),
        ("rbdout.A.speed.x + 1", "unknown rbdout quantity 'speed.x'"),
        ("rbdout.A.velocity.ids", "unknown rbdout quantity"),
    ],
)
def test_an_unknown_channel_is_refused_at_its_first_wrong_word(
    cars: Path, name: str, words: str
) -> None:
    with pytest.raises(PostError) as refusal:
        Result(cars).series(name)
    assert words in str(refusal.value)


def read_all(folder: Path) -> list[Series]:
    result = Result(folder)
    return [result.series(channel.name) for channel in result.channels()]


def test_every_history_cut_short_is_refused(tmp_path: Path, cars: Path) -> None:
    """A file cut short, as by a full disk or a broken copy, never ends in a traceback."""
    whole = (cars / "history.h5").read_bytes()
    for size in np.linspace(0, len(whole) - 1, 60).astype(int):
        (tmp_path / "history.h5").write_bytes(whole[:size])
        with pytest.raises(PostError):
            read_all(tmp_path)


def test_missing_and_foreign_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(PostError, match="no such file; name a results folder"):
        Result(tmp_path)
    with h5py.File(tmp_path / "history.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(PostError, match="not a crashsolve history"):
        Result(tmp_path)


def test_another_format_version_is_refused(cars: Path) -> None:
    with h5py.File(cars / "history.h5", "r+") as file:
        file.attrs["format_version"] = 3
    with pytest.raises(PostError, match="format version 3, this program reads 1 to 2"):
        Result(cars)


def test_a_group_without_ids_is_refused(cars: Path) -> None:
    with h5py.File(cars / "history.h5", "r+") as file:
        del file["rbdout/ids"]
    with pytest.raises(PostError, match=r"not as FILE_FORMAT\.md has it"):
        Result(cars)


def test_a_missing_or_broken_status_is_unknown(cars: Path) -> None:
    for text in ("", "{", "[1]", "{}"):
        (cars / "status.json").write_text(text)
        assert Result(cars).status == {"state": "unknown"}
    write_status(cars, "running")
    assert not Result(cars).finished


def test_a_running_state_without_its_process_is_a_killed_run(cars: Path) -> None:
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    write_status(cars, "running", host=socket.gethostname(), pid=gone.pid)
    assert Result(cars).status["state"] == "killed"
    write_status(cars, "running", host=socket.gethostname(), pid=os.getpid())
    assert Result(cars).status["state"] == "running"
    write_status(cars, "running", host="another", pid=gone.pid)
    assert Result(cars).status["state"] == "running"


def test_broken_json_in_an_attribute_is_refused(tmp_path: Path) -> None:
    result = Result(write_result(tmp_path, two_cars(), expect="{", report=json.dumps(None)))
    assert result.stored_json("absent") is None
    assert result.stored_json("report") is None
    with pytest.raises(PostError, match="attribute 'expect' is not JSON"):
        result.stored_json("expect")
