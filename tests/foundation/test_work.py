"""Claim: two processes compile each unit once; what one of them cannot, the other does."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from crashsolve.compiler import work
from crashsolve.compiler.cache import read_sealed
from crashsolve.compiler.work import Unit, Work


def done(compile_text: Callable[[str], bytes], folder: Path, count: int = 20) -> Work:
    finished = Work(compile_text)
    for k in range(count):
        finished.add(Unit(folder / f"{k}.o", str(k) * (k + 1)))
    finished.finish()
    return finished


@pytest.fixture(autouse=True)
def shared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(work, "LONG", 0)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})


def test_each_unit_is_compiled_once_and_kept(tmp_path: Path) -> None:
    def compile_text(text: str) -> bytes:
        with open(tmp_path / "compiled.txt", "a", encoding="utf-8") as file:
            file.write(f"{text}\n")
        return text.encode()

    finished = done(compile_text, tmp_path)
    expected = {tmp_path / f"{k}.o": (str(k) * (k + 1)).encode() for k in range(20)}
    assert finished.codes == expected
    assert {path: read_sealed(path) for path in expected} == expected
    compiled = (tmp_path / "compiled.txt").read_text("utf-8").split()
    assert sorted(compiled) == sorted(code.decode() for code in expected.values())


def test_a_process_that_dies_leaves_its_unit_to_the_other(tmp_path: Path) -> None:
    here = os.getpid()

    def compile_text(text: str) -> bytes:
        if os.getpid() != here:
            os._exit(1)
        return text.encode()

    assert len(done(compile_text, tmp_path).codes) == 20


def test_an_error_of_both_is_shown(tmp_path: Path) -> None:
    def compile_text(text: str) -> bytes:
        raise RuntimeError(f"not {text}")

    with pytest.raises(RuntimeError, match="not "):
        done(compile_text, tmp_path)
