"""The commands as a user starts them: separate processes, in folders of their own."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import forked
import h5py
import numpy as np

# what the tests set for themselves must not reach a run
OWN = ("CRASHSOLVE_PLAIN",)
# [s] that no run takes: the longest, a crushed tube, wants 300 s of CPU, more beside others
HANGS = 1800


def environment(**changes: str) -> dict[str, str]:
    """The environment of a run: that of the tests, less what concerns the tests alone."""
    return {k: v for k, v in os.environ.items() if k not in OWN} | changes


def arguments(*words: object) -> list[str]:
    return [sys.executable, "-m", "crashsolve", *map(str, words)]


def crashsolve(*words: object, **changes: str) -> subprocess.CompletedProcess[str]:
    """Run the command to its end; `changes` are environment variables."""
    given = environment(**changes)
    # the runs of a sweep have none of its files, among them the pipes to the compiler of the tests
    if forked.can_fork(given) and words[0] != "sweep":
        return forked.completed([str(word) for word in words], given, HANGS)
    return subprocess.run(
        arguments(*words), capture_output=True, text=True, timeout=HANGS, env=given
    )


def start(*words: object, **changes: str) -> subprocess.Popen[str]:
    """Start the command without waiting for it."""
    return subprocess.Popen(
        arguments(*words),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(**changes),
    )


def datasets(path: Path) -> dict[str, np.ndarray]:
    """All datasets of an HDF5 file by their paths."""
    arrays: dict[str, np.ndarray] = {}

    def keep(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset):
            text = h5py.check_string_dtype(item.dtype)
            arrays[name] = item.asstr()[()].astype(str) if text else item[()]

    with h5py.File(path) as file:
        file.visititems(keep)
    return arrays


def results(folder: Path) -> dict[str, np.ndarray]:
    """Every number a run has written: histories, states, newest dump."""
    files = [folder / "history.h5", folder / "mesh.h5", *sorted((folder / "states").glob("*.h5"))]
    dumps = sorted(folder.glob("restart_*.h5"), key=_serial)
    content = {
        f"{path.relative_to(folder)}:{name}": array
        for path in files
        for name, array in datasets(path).items()
    }
    if not dumps:
        return content
    return content | {f"dump:{name}": array for name, array in datasets(dumps[-1]).items()}


def differences(one: Path, other: Path) -> list[str]:
    """Names of the datasets that are not the same to the last bit."""
    a, b = results(one), results(other)
    both = a.keys() & b.keys()
    return sorted(a.keys() ^ b.keys()) + sorted(k for k in both if not _same_bits(a[k], b[k]))


def _same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes()


def _serial(path: Path) -> int:
    with h5py.File(path) as file:
        return int(file.attrs["serial"])


def check_restart_after_signal(deck: Path, whole: Path, cut: Path, *words: str) -> None:
    """A run that SIGTERM stops after its first state continues to the bits of `whole`."""
    # on a busy machine the run may end before the signal is sent: then try again
    for _ in range(10):
        shutil.rmtree(cut, ignore_errors=True)
        run = start(deck, "-o", cut, *words)
        until = time.monotonic() + 600
        while not (cut / "states/000001.h5").exists() and time.monotonic() < until:
            time.sleep(0.001)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=600)
        if run.returncode == 3:
            break
    assert run.returncode == 3
    assert crashsolve(deck, "-o", cut, "--restart").returncode == 0
    assert differences(cut, whole) == []


def gone_on(deck: Path, whole: Path, again: Path) -> str:
    """Output of a run that continues from the dump before the last, to the bits of `whole`."""
    printed = go_on(deck, whole, again)
    assert differences(again, whole) == []
    return printed


def go_on(deck: Path, whole: Path, again: Path, *words: str) -> str:
    """Continue a run from the dump before the last, in a copy; returns its output."""
    shutil.copytree(whole, again)
    max(again.glob("restart_*.h5"), key=lambda path: path.stat().st_mtime_ns).unlink()
    done = crashsolve(deck, "-o", again, "--restart", *words)
    assert done.returncode == 0, done.stderr
    assert "continuing from t = " in done.stdout
    return done.stdout
