"""Claim: what a run will write is said before it, within a tenth, and refused beyond the disk."""

import re
from pathlib import Path

import pytest
from command import crashsolve

from crashsolve.output import size

DECK = """
title: balls
control: {end_time: 1, step: 1e-3, estimate: off}
bodies:
  a: {mass: 1, inertia: [1, 1, 1]}
  b: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 1]}
loads: {w: {type: gravity}}
output: {history: {interval: INTERVAL}}
"""
UNITS = {"kB": 1e3, "MB": 1e6, "GB": 1e9}


def written(folder: Path, interval: str) -> Path:
    deck = folder / "deck.yaml"
    deck.write_text(DECK.replace("INTERVAL", interval), "utf-8")
    return deck


def test_the_size_of_a_history_is_as_said(tmp_path: Path) -> None:
    deck = written(tmp_path, "1e-4")
    said = crashsolve("check", deck).stdout
    number, unit = re.findall(r"history of 1e\+04 samples: (\S+) (\w+)", said)[0]
    assert crashsolve(deck, "-o", tmp_path / "out").returncode == 0
    real = (tmp_path / "out" / "history.h5").stat().st_size
    # headers and names beside the numbers
    assert float(number) * UNITS[unit] == pytest.approx(real, rel=0.1)
    assert "output: history of" in (tmp_path / "out" / "log.txt").read_text("utf-8")[:3000]


@pytest.mark.parametrize(
    ("interval", "end", "message"),
    [
        ("1e-12", "1", "free on the disk"),
        ("1e-14", "1e6", "1e+06 s at 1e-14 s have too many samples to be numbered"),
        ("1e-4", "1e308", "1e+308 s at 0.0001 s have too many samples to be numbered"),
    ],
)
@pytest.mark.parametrize("command", [("check",), ()])
def test_more_than_the_disk_has_free_is_refused(
    tmp_path: Path, interval: str, end: str, message: str, command: tuple[str, ...]
) -> None:
    deck = written(tmp_path, interval)
    word = ("--set", f"control.end_time={end}")
    done = crashsolve(*command, deck, *word, *([] if command else ["-o", tmp_path / "out"]))
    assert done.returncode == 2
    assert message in done.stderr and "longer output.history.interval" in done.stderr
    assert not (tmp_path / "out" / "history.h5").exists()


def test_sizes_are_read_in_common_units() -> None:
    assert [size.in_words(x) for x in (0.0, 999.0, 2.5e3, 1e12)] == [
        "0 bytes",
        "999 bytes",
        "2.5 kB",
        "1 TB",
    ]
