"""Restart dumps: bit for bit, two in turn, and never none."""

import os
import random
import signal
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from crashsolve.output.errors import OutputError
from crashsolve.output.restart import SLOTS, newest_restart, write_restart


def read(folder: Path) -> tuple[int, list[str]]:
    """Number inside the newest valid dump, and what was said about the others."""
    said: list[str] = []
    dump = newest_restart(folder, said.append)
    assert dump is not None
    arrays, info = dump
    assert (arrays["x"] == info["number"]).all()
    return info["number"], said


def write(folder: Path, number: int) -> Path:
    """Write a dump that carries a number."""
    return write_restart(folder, {"x": np.full(50, float(number))}, {"number": number})


def test_dump_returns_the_same_bits(tmp_path: Path) -> None:
    history = np.zeros(3, [("force", "<f8", (3,)), ("node", "<i8"), ("open", "?")])
    history["force"] = np.random.default_rng(1).normal(size=(3, 3))
    arrays = {
        "state/position": np.array([[0.1 + 0.2, -0.0, 5e-324], [np.nan, np.inf, 1 / 3]]),
        "state/time": np.array(1e-3),
        "history/spring": history,
        "flags": np.array([True, False]),
        "none": np.empty((0, 3)),
        "one": history[:1].reshape(()),
        "counts": np.arange(5),
    }
    info = {"time": 0.1 + 0.2, "cycle": 12, "deck": "größe"}
    write_restart(tmp_path, arrays, info)
    dump, reported = newest_restart(tmp_path) or ({}, {})
    assert reported == info
    assert dump.keys() == arrays.keys()
    for name, array in arrays.items():
        assert dump[name].dtype == array.dtype
        assert dump[name].shape == array.shape
        assert dump[name].tobytes() == array.tobytes()


def test_dump_may_be_empty(tmp_path: Path) -> None:
    write_restart(tmp_path, {}, {})
    assert newest_restart(tmp_path) == ({}, {})


def test_dumps_take_turns_and_the_newest_is_read(tmp_path: Path) -> None:
    assert newest_restart(tmp_path) is None
    slots = []
    for number in range(5):
        slots.append(write(tmp_path, number).name)
        assert read(tmp_path) == (number, [])
    assert slots == [SLOTS[0], SLOTS[1], SLOTS[0], SLOTS[1], SLOTS[0]]


@pytest.mark.parametrize("damage", ["flip", "truncate", "empty", "format"])
def test_broken_dump_is_passed_over_with_the_reason(tmp_path: Path, damage: str) -> None:
    write(tmp_path, 1)
    newest = write(tmp_path, 2)
    break_dump(newest, damage)
    number, said = read(tmp_path)
    assert number == 1
    assert len(said) == 1
    assert newest.name in said[0]
    # the next dump must not replace the one that still works
    write(tmp_path, 3)
    break_dump(newest, damage)
    assert read(tmp_path)[0] in (1, 3)


def test_nothing_valid_is_an_error(tmp_path: Path) -> None:
    for number in range(2):
        break_dump(write(tmp_path, number), "flip")
    with pytest.raises(OutputError, match="all of them are broken"):
        newest_restart(tmp_path, lambda text: None)


def test_kill_at_random_moments_leaves_the_last_dump(tmp_path: Path) -> None:
    dice = random.Random(4)
    for _ in range(15):
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            for number in range(255):
                write(tmp_path, number)
                os.write(writing, bytes([number]))
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as reader:
            first = reader.read(1)
            time.sleep(dice.uniform(0.0, 0.05))
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            last = (first + reader.read())[-1]
        number, said = read(tmp_path)
        assert last <= number <= last + 1
        assert said == []


def break_dump(path: Path, damage: str) -> None:
    """Spoil a dump in one of several ways."""
    if damage == "flip":
        with h5py.File(path, "r+") as file:
            file["arrays/x"][7] += 1e-9
    elif damage == "format":
        with h5py.File(path, "r+") as file:
            file.attrs["format_version"] = 99
    else:
        os.truncate(path, 0 if damage == "empty" else path.stat().st_size // 2)
