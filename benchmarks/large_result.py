"""Memory and CPU time of crashpost with results of 2 GB: `python benchmarks/large_result.py`.

Two results are written, after FILE_FORMAT.md: one of many channels (4,000 nodes and 2,000 contacts,
2,400 samples) with states of 100,000 shells, one of many samples (16 nodes, 10 contacts, 10^6).
Figures are CPU seconds and the largest memory of any of a command's processes.
"""

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from multiprocessing import Process, Queue
from pathlib import Path

import h5py
import numpy as np

AXES = ("x", "y", "z")
MOTION = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "angular_velocity": "rad/s"}
STATES, SHELLS = 30, 316


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, help="where the results go; removed at the end")
    folder = Path(tempfile.mkdtemp(dir=parser.parse_args().folder))
    try:
        many_channels = write(folder / "channels", bodies=4000, contacts=2000, samples=2400)
        write_states(many_channels)
        many_samples = write(folder / "samples", bodies=16, contacts=10, samples=1_000_000)
        for result in (many_channels, many_samples):
            size = sum(path.stat().st_size for path in result.rglob("*.h5"))
            print(f"{result.name}: {size / 1e9:.2f} GB")
            for words in (
                ("value", result, "rbdout.node_1.position.x:max"),
                ("summary", result),
                ("plot", result, "rbdout.node_1.position.x"),
                ("report", result),
                *([("render", result)] if (result / "states").is_dir() else []),
            ):
                seconds, megabytes = measure(words)
                print(f"  {words[0]:8} {seconds:6.2f} s of CPU, {megabytes:5.0f} MB")
    finally:
        shutil.rmtree(folder)


def write(folder: Path, bodies: int, contacts: int, samples: int) -> Path:
    """A result of bodies that swing and contacts that push, in the layout of a finished run."""
    folder.mkdir()
    time = np.linspace(0.0, 1.0, samples)
    vectors = {f"{name}/{axis}": unit for name, unit in MOTION.items() for axis in AXES}
    pushes = {"normal": "N", "depth": "m", "touching": "1", "first_touch": "s", "last_release": "s"}
    families = {
        "glstat": (
            {"energy/kinetic": "J", "energy/imbalance": "J", "energy/largest": "J"},
            ["model"],
        ),
        "rbdout": (vectors | {f"force/{axis}": "N" for axis in AXES}, names("node", bodies)),
        "rcforc": (pushes | {f"force/{axis}": "N" for axis in AXES}, names("hit", contacts)),
    }
    with h5py.File(folder / "history.h5", "w") as file:
        file.attrs.update(
            {"format": "crashsolve history", "format_version": 2, "title": folder.name}
        )
        for word, (columns, ids) in families.items():
            group = file.create_group(word)
            group["time"] = file.get("glstat/time", time)
            group["ids"] = np.array(ids, object)
            for k, (path, unit) in enumerate(columns.items()):
                data = group.create_dataset(path, (samples, len(ids)), "<f8")
                data.attrs["unit"] = unit
                phases = np.linspace(0.0, 3.0, len(ids))
                # in slices: this program must not need more memory than those it measures
                for rows in np.array_split(np.arange(samples), 40):
                    data[rows[0] : rows[-1] + 1] = np.sin(9.0 * time[rows][:, None] + phases + k)
    (folder / "status.json").write_text(
        json.dumps({"state": "finished", "time": 1.0, "end_time": 1.0})
    )
    return folder


def names(word: str, count: int) -> list[str]:
    return [f"{word}_{k}" for k in range(count)]


def write_states(folder: Path) -> None:
    """A square of shells that swings."""
    n = SHELLS + 1
    grid = np.arange(n * n).reshape(n, n)
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)])
    (folder / "states").mkdir()
    with h5py.File(folder / "mesh.h5", "w") as file:
        file.attrs.update({"format": "crashsolve states", "format_version": 3})
        file.attrs["names"] = json.dumps({"bodies": ["ground"], "parts": ["sheet"], "contacts": []})
        file["part_sheet/points"] = points
        file["part_sheet/cells"] = np.stack(corners, axis=-1).reshape(-1, 4)
    for k in range(STATES):
        moved = np.zeros((n * n, 3), "f4")
        moved[:, 2] = 0.2 * k / STATES * np.sin(6.0 * points[:, 0]) * np.cos(5.0 * points[:, 1])
        with h5py.File(folder / "states" / f"{k:06d}.h5", "w") as file:
            file.attrs["time"] = k / (STATES - 1)
            file["part_sheet/displacement"] = moved
            file["part_sheet/plastic_strain_top"] = np.abs(moved[: SHELLS**2, 2])


def measure(words: tuple[object, ...]) -> tuple[float, float]:
    """CPU time [s] and largest memory [MB] of a command and its child processes."""
    answer: Queue = Queue()
    child = Process(target=_run, args=(answer, [str(word) for word in words]))
    child.start()
    answered = answer.get()
    child.join()
    if isinstance(answered, str):
        raise SystemExit(answered)
    return answered


def _run(answer: Queue, words: list[str]) -> None:
    # a process of its own counts the children of this command alone
    done = subprocess.run(
        [sys.executable, "-m", "crashpost", *words], capture_output=True, text=True
    )
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    measured = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
    answer.put(measured if done.returncode == 0 else f"{' '.join(words)}: {done.stderr}")


if __name__ == "__main__":
    main()
