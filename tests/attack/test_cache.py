"""Claim: compiled code is loaded whole, and from a folder that nobody else can write."""

import errno
import os
import pickle
import random
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve

from crashsolve.compiler import cache, machine
from crashsolve.compiler.cache import CacheError, find_folder, locked, read_sealed, write_sealed
from crashsolve.compiler.table import Tables
from crashsolve.system import compose

OSCILLATOR = Path(__file__).parents[1] / "runs" / "oscillator.yaml"
CODE = bytes(random.Random(1).randbytes(5000))


def flipped(content: bytes, at: int) -> bytes:
    return content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda b: b"",
    "one byte": lambda b: b[:1],
    "half": lambda b: b[: len(b) // 2],
    "last byte missing": lambda b: b[:-1],
    "a byte more": lambda b: b + b"\0",
    "zeros": lambda b: bytes(len(b)),
    "zeros at the end": lambda b: b[:-512] + bytes(512),
    "first bit": lambda b: flipped(b, 0),
    "bit of the names": lambda b: flipped(b, 45),
    "bit in the middle": lambda b: flipped(b, len(b) // 2),
    "last bit": lambda b: flipped(b, len(b) - 1),
    "two pages in turn": lambda b: b[:512] + b[1024:1536] + b[512:1024] + b[1536:],
    "text": lambda b: b"not code at all\n",
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_is_as_good_as_absent(
    damage: Callable[[bytes], bytes], tmp_path: Path
) -> None:
    path = tmp_path / "step.o"
    write_sealed(path, CODE)
    assert read_sealed(path) == CODE
    path.write_bytes(damage(path.read_bytes()))
    assert read_sealed(path) is None


def test_a_file_under_the_name_of_another_is_not_it(tmp_path: Path) -> None:
    write_sealed(tmp_path / "one.o", CODE)
    shutil.copy(tmp_path / "one.o", tmp_path / "other.o")
    assert read_sealed(tmp_path / "other.o") is None


def test_what_is_no_plain_file_is_not_read_nor_waited_for(tmp_path: Path) -> None:
    write_sealed(tmp_path / "step.o", CODE)
    (tmp_path / "link").mkdir()
    os.symlink(tmp_path / "step.o", tmp_path / "link" / "step.o")
    os.mkfifo(tmp_path / "pipe.o")
    for name in ("link/step.o", "pipe.o", "link", "absent.o"):
        assert read_sealed(tmp_path / name) is None


KERNELS = """
from crashsolve.foundation.kernels import entry, kernel

@kernel
def inner(x):
    return 2.0 * x

@entry
def work(number, flag, scene):
    scene.sums[0] = inner(number)
"""


def doubled(number: float, source: Path) -> float:
    """What the compiled kernels make of a number, loaded anew."""
    tables = Tables({"sums": np.zeros(1)})
    machine._linked.clear()
    machine.machine_code(source, "work", tables)(number, False, tables)
    return float(tables.sums[0])


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of kernels, and a folder for its code."""
    folder = tmp_path / "sources_1"
    folder.mkdir()
    monkeypatch.setattr(machine, "_linked", {})
    monkeypatch.setattr(machine, "cache_folder", lambda: folder)
    path = tmp_path / "scene.py"
    path.write_text(KERNELS, "utf-8")
    return path


def test_a_damaged_cache_is_healed(source: Path, tmp_path: Path) -> None:
    assert doubled(1.5, source) == 3.0
    (code,), (kept,) = (tmp_path / "sources_1").glob("*.o"), (tmp_path / "code").glob("*.o")
    whole = kept.read_bytes()
    code.write_bytes(flipped(code.read_bytes(), 500))
    kept.write_bytes(flipped(whole, len(whole) // 2))
    assert doubled(2.5, source) == 5.0
    assert kept.read_bytes() == whole
    assert read_sealed(code) == pickle.dumps([read_sealed(kept)])


def test_other_sources_with_the_same_kernels_compile_nothing(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert doubled(1.5, source) == 3.0
    (kept,) = (tmp_path / "code").glob("*.o")
    before = kept.stat()
    (tmp_path / "sources_2").mkdir()
    monkeypatch.setattr(machine, "cache_folder", lambda: tmp_path / "sources_2")
    source.write_text(f"# a remark\n{KERNELS}", "utf-8")
    assert doubled(2.0, source) == 4.0
    assert kept.stat() == before or kept.stat().st_mtime_ns == before.st_mtime_ns
    source.write_text(KERNELS.replace("2.0", "3.0"), "utf-8")
    (tmp_path / "sources_3").mkdir()
    monkeypatch.setattr(machine, "cache_folder", lambda: tmp_path / "sources_3")
    assert doubled(2.0, source) == 6.0
    assert len([*(tmp_path / "code").glob("*.o")]) == 2


def test_of_sixteen_that_begin_together_one_compiles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, compiled = tmp_path / "step.o", []

    def compile_slowly(*_: object) -> bytes:
        compiled.append(1)
        time.sleep(0.2)
        write_sealed(path, CODE)
        return CODE

    monkeypatch.setattr(machine, "_compile_apart", compile_slowly)
    # every one has a descriptor of its own, as a process has
    with ThreadPoolExecutor(16) as pool:
        jobs = [pool.submit(machine._compile_once, path, (), None, path) for _ in range(16)]
        assert [job.result(timeout=60) for job in jobs] == [CODE] * 16
    assert len(compiled) == 1
    assert [entry.name for entry in tmp_path.iterdir()] == ["step.o"]


HOLDER = """
import sys, time
from pathlib import Path
from crashsolve.compiler.cache import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(600)
"""


def test_the_lock_of_a_process_that_was_killed_holds_nobody_up(tmp_path: Path) -> None:
    path = tmp_path / "step.o"
    words = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        taken = threading.Event()

        def take() -> None:
            with locked(path):
                taken.set()

        other = threading.Thread(target=take)
        other.start()
        assert not taken.wait(0.3)
        holder.kill()
        assert taken.wait(60)
        other.join()
    assert list(tmp_path.iterdir()) == []


def test_without_locks_every_run_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOLCK, "no locks available")

    monkeypatch.setattr(cache.fcntl, "flock", refuse)
    with cache.locked(tmp_path / "step.o") as lock:
        assert lock is None


def test_an_empty_step_file_is_healed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compose, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(compose, "runs_plain", lambda: False)
    monkeypatch.setattr(compose, "machine_code", lambda path, *_: path)
    tables = Tables({"sums": np.zeros(1)})
    path = compose.load("text of a step", tables)
    assert path.read_text() == "text of a step"
    for damaged in ("", "text of", "text of a stop"):
        path.write_text(damaged)
        assert compose.load("text of a step", tables).read_text() == "text of a step"


def chosen(monkeypatch: pytest.MonkeyPatch, folder: Path) -> Path:
    monkeypatch.setenv("CRASHSOLVE_CACHE", str(folder))
    return find_folder("0123")


def test_folders_are_made_for_the_user_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = os.umask(0)
    try:
        folder = chosen(monkeypatch, tmp_path / "a" / "b")
    finally:
        os.umask(old)
    assert folder == tmp_path / "a" / "b" / "0123"
    for path in (folder, folder.parent, folder.parent.parent):
        assert path.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("mode", [0o777, 0o757, 0o702])
@pytest.mark.parametrize("where", ["open", "open/below", "open/below/0123"])
def test_a_chosen_folder_that_others_can_write_is_refused(
    mode: int, where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    below = tmp_path / "open" / "below"
    (below / "0123").mkdir(parents=True, mode=0o755)
    (tmp_path / where).chmod(mode)
    with pytest.raises(CacheError, match=rf"others can write to {tmp_path / where}; chmod go-w"):
        chosen(monkeypatch, below)


def test_a_sticky_parent_folder_is_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o1777)
    assert chosen(monkeypatch, tmp_path / "open" / "own").exists()


def test_a_folder_or_link_of_another_user_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own").mkdir()
    os.symlink(tmp_path / "own", tmp_path / "link")
    # as if another user asked
    monkeypatch.setattr(cache.os, "geteuid", lambda: os.getuid() + 4321)
    info = (tmp_path / "own").lstat()
    if info.st_uid == 0:
        pytest.skip("root's own folders are trusted by everybody")
    for name in ("own", "link"):
        with pytest.raises(CacheError, match="belongs to another user"):
            chosen(monkeypatch, tmp_path / name)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give files away")
def test_what_another_user_has_put_into_the_temporary_folder_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CRASHSOLVE_CACHE", "")
    monkeypatch.setenv("XDG_CACHE_HOME", os.devnull)
    monkeypatch.setattr(cache.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(cache.tempfile, "gettempdir", lambda: str(tmp_path))
    tmp_path.chmod(0o1777)
    trap = tmp_path / "crashsolve-0"
    (trap / "0123").mkdir(parents=True)
    for path in (trap, trap / "0123"):
        os.chown(path, 12345, 12345)
    folder = find_folder("0123")
    assert trap not in folder.parents
    assert folder.stat().st_mode & 0o777 == 0o700
    assert os.environ["CRASHSOLVE_CACHE"] == str(folder.parent)
    # the trap may as well be a link to a folder of this user's
    shutil.rmtree(trap)
    (tmp_path / "precious").mkdir(mode=0o700)
    os.symlink(tmp_path / "precious", trap)
    os.chown(trap, 12345, 12345, follow_symlinks=False)
    monkeypatch.setenv("CRASHSOLVE_CACHE", "")
    find_folder("0123")
    assert not os.listdir(tmp_path / "precious")


def test_a_chosen_folder_of_others_ends_a_run_with_one_line(tmp_path: Path) -> None:
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache").chmod(0o777)
    done = crashsolve(OSCILLATOR, "-o", tmp_path / "out", CRASHSOLVE_CACHE=str(tmp_path / "cache"))
    assert done.returncode == 5
    assert "others can write to" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("kind", ["file", "below a file", "read-only"])
def test_a_chosen_folder_that_cannot_be_written_is_refused(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = tmp_path / "chosen"
    if kind == "read-only":
        given.mkdir()
        # root may write wherever it likes
        monkeypatch.setattr(cache, "_is_writable", lambda folder: False)
    else:
        given.write_text("no folder", "utf-8")
    with pytest.raises(CacheError, match=r"CRASHSOLVE_CACHE=.*compiled code cannot be there"):
        chosen(monkeypatch, given / "below" if kind == "below a file" else given)
    assert given.is_dir() or given.read_text("utf-8") == "no folder"


def test_another_compiler_has_another_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    here = cache.cache_folder()
    monkeypatch.setattr(cache.llvmlite, "__version__", "another")
    cache.cache_folder.cache_clear()
    try:
        assert cache.cache_folder().name != here.name
    finally:
        cache.cache_folder.cache_clear()
