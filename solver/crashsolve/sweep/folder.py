"""The folder of a sweep: sweep.json with all its runs, and the status of each run.

A run is marked by its sources: the deck with its includes and its own values, the other
files that the deck reads, and the sources of crashsolve. A result with another mark does not count.
The status of a run is read from its files: so it survives the process that started the run.
"""

import hashlib
import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import crashsolve
from crashsolve.deck.card import Card
from crashsolve.deck.family import CHOSEN
from crashsolve.deck.laws import package_folder
from crashsolve.deck.reading.deck import Deck
from crashsolve.foundation.errors import DeckError, ExitCode
from crashsolve.output.files import Json, replace_text, reported
from crashsolve.output.lock import NAME as LOCK
from crashsolve.output.lock import is_held
from crashsolve.study.child_runs import status_of, table_in
from crashsolve.sweep.axis import Axis
from crashsolve.sweep.design import Point
from crashsolve.sweep.plan import Plan

NAME, RECORD, ERRORS = "sweep.json", "run.json", "errors.txt"
FORMAT, FORMAT_VERSION = "crashsolve sweep", 1
AUTO = "auto-"
_METHOD = re.compile(r"(?m)^  integrator: .*\n")


@dataclass(frozen=True)
class Mark:
    """Hashes of the inputs of a result."""

    deck: str
    files: str
    version: str

    def difference_from(self, other: Json) -> str:
        """Difference from another mark in words; empty for the same."""
        words = {"deck": "another deck or other values", "files": "other files that the deck reads"}
        words["version"] = "another version of crashsolve"
        own = asdict(self)
        return ", ".join(words[name] for name in words if other.get(name) != own[name])


@dataclass(frozen=True)
class Run:
    """One run of a sweep: its number from 1, its values, all that it sets in the deck.

    `span` is its simulated time [s].
    """

    number: int
    values: Point
    overrides: dict[str, str]
    mark: Mark
    span: float = 0.0

    @property
    def name(self) -> str:
        """Name of the run and of its folder."""
        return f"{self.number:04d}"

    def folder(self, sweep: Path) -> Path:
        """Folder of its results."""
        return sweep / "runs" / self.name

    def reported(self) -> str:
        """Values of the run, for messages."""
        return ", ".join(f"{name} = {text}" for name, text in self.values.items())


@dataclass(frozen=True)
class RunStatus:
    """State of a run: new, stale, held, running, finished, failed, stopped or killed."""

    state: str
    message: str = ""


def mark_of(deck: Deck) -> Mark:
    """The mark of a run of this deck. Raises OutputError for a file that cannot be read."""
    files = hashlib.sha256()
    for path in sorted(set(_files_of(deck))):
        with reported(path):
            files.update(_digest(path, path.stat().st_mtime_ns))
    is_auto = deck.control.integrator in CHOSEN
    return Mark(text_mark(deck.text, is_auto), files.hexdigest()[:16], version_mark())


def text_mark(text: str, is_auto: bool) -> str:
    """Hash of the text of a deck, as sweep.json and history.h5 have it.

    With `integrator: auto` or `default` without its line: results state the method that was chosen.
    """
    compared = _METHOD.sub("", text) if is_auto else text
    return is_auto * AUTO + hashlib.sha256(compared.encode()).hexdigest()[:16]


@cache
def version_mark() -> str:
    """Version of crashsolve with a hash of its sources."""
    digest, root = hashlib.sha256(), package_folder()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return f"{crashsolve.__version__}-{digest.hexdigest()[:12]}"


@cache
def _digest(path: Path, _: int) -> bytes:
    """Hash of a file, read once for all runs."""
    return hashlib.sha256(path.read_bytes()).digest()


def _files_of(deck: Deck) -> Iterator[Path]:
    """Files that cards name: meshes, curves. Those of the deck itself are in its text."""
    for entries in deck.entries.values():
        for entry in entries.values():
            yield from _named_in(entry.card)


def _named_in(value: object) -> Iterator[Path]:
    if isinstance(value, tuple):
        for part in value:
            yield from _named_in(part)
    elif isinstance(value, Card):
        for name in type(value).model_fields:
            part = getattr(value, name)
            if name == "file" and isinstance(part, str):
                yield Path(part)
            yield from _named_in(part)


def write_sweep(folder: Path, plan: Plan, title: str, runs: list[Run]) -> None:
    """Write sweep.json, which crashpost and the tasks of a queue read. Raises OutputError."""
    data = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": title,
        "plan": str(plan.path.resolve()),
        "deck": str(plan.deck),
        "design": plan.card.design.type,
        "axes": [_axis_data(name, axis) for name, axis in plan.axes.items()],
        "measures": [
            {"name": m.title, **m.model_dump(exclude={"name"})} for m in plan.card.measure
        ],
        "runs": [asdict(run) | {"folder": f"runs/{run.name}"} for run in runs],
    }
    replace_text(folder / NAME, json.dumps(data, indent=1, ensure_ascii=False) + "\n")


def _axis_data(name: str, axis: Axis) -> Json:
    scale = "log" if axis.distribution in ("log_uniform", "lognormal") else "linear"
    return {"name": name, "unit": axis.unit, "is_of_numbers": axis.is_of_numbers, "scale": scale}


def read_sweep(folder: Path) -> tuple[Path, list[Run]]:
    """The deck and the runs that sweep.json names. Raises DeckError where there is none."""
    data = table_in(folder / NAME)
    if data.get("format") != FORMAT or data.get("format_version") != FORMAT_VERSION:
        advice = "prepare it by crashsolve sweep PLAN -o FOLDER --slurm"
        raise DeckError(str(folder), None, None, "", f"has no {NAME} of this version", advice)
    runs = [
        Run(entry["number"], entry["values"], entry["overrides"], Mark(**entry["mark"]))
        for entry in data["runs"]
    ]
    return Path(data["deck"]), runs


def run_status(sweep: Path, run: Run) -> RunStatus:
    """State of a run by its files."""
    folder = run.folder(sweep)
    record = table_in(folder / RECORD)
    if not record:
        return RunStatus("stale", "unknown results") if _has_results(folder) else RunStatus("new")
    if is_held(folder):
        return RunStatus("held", "runs already")
    difference = run.mark.difference_from(record.get("mark", {}))
    if difference:
        return RunStatus("stale", difference)
    status = status_of(folder)
    state, code = status.get("state"), status.get("exit_code")
    if (state, code) == ("finished", int(ExitCode.NORMAL)):
        difference = _text_difference(folder, run.mark)
        return RunStatus("stale", difference) if difference else RunStatus("finished")
    if state in ("failed", "stopped"):
        return RunStatus(state, str(status.get("message", "")))
    if record.get("state") == "failed":
        # it ended before it had a status
        return RunStatus("failed", str(record.get("message", "")))
    if not status:
        return RunStatus("new")
    # a status of running, without such a process
    word = "stopped" if record.get("state") == "stopped" else "killed"
    return RunStatus(word, str(record.get("message", "")))


def _has_results(folder: Path) -> bool:
    return (folder / "history.h5").exists() or (folder / "status.json").exists()


def _text_difference(folder: Path, mark: Mark) -> str:
    """Reason why finished results are of another deck, as after a run by hand in this folder."""
    import h5py

    try:
        with h5py.File(folder / "history.h5") as file:
            text = str(file.attrs["deck_text"])
            is_same = text_mark(text, mark.deck.startswith(AUTO)) == mark.deck
    except (OSError, KeyError):
        return "damaged results"
    return "" if is_same else "another deck or other values"


def clear(sweep: Path, run: Run) -> None:
    """Remove all that a run has left but its lock, its mark last. Raises OutputError."""
    folder = run.folder(sweep)
    with reported(folder):
        left = [path for path in folder.iterdir() if path.name != LOCK]
        for path in sorted(left, key=lambda path: path.name == RECORD):
            shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


def record(sweep: Path, run: Run, state: str, code: int | None = None, message: str = "") -> None:
    """Write the input of a run and its status. Raises OutputError."""
    data: Json = {"mark": asdict(run.mark), "overrides": run.overrides, "state": state}
    data |= {"exit_code": code, "message": message}
    replace_text(run.folder(sweep) / RECORD, json.dumps(data, indent=1, ensure_ascii=False) + "\n")
