"""Runs from Python: `from crashsolve import run`.

A run is the command `crashsolve run` in a process of its own: its signals, its memory and its
compiled code are none of the caller's, and its bits are those of the command line.
"""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryFile

from crashsolve.foundation.errors import CrashsolveError, ExitCode


class RunFailed(CrashsolveError):
    """A run that did not reach its end: cause, exit code and results so far."""

    def __init__(self, message: str, exit_code: int, folder: Path) -> None:
        self.message, self.exit_code, self.folder = message, exit_code, folder
        super().__init__(message, exit_code, folder)

    def __str__(self) -> str:
        return self.message


def run(
    deck: Path | str | Mapping[str, object],
    folder: Path | str | None = None,
    *,
    set: Mapping[str, object] | None = None,
    restart: bool = False,
    report: Callable[[str], object] | None = None,
) -> Path:
    """Solve a deck; returns its results folder, and raises RunFailed where it does not end.

    `deck` is a path, or the deck itself as a dict, which is then written to deck.yaml of the
    folder: files that it names are looked for there. `folder` is DECK.results when
    absent. `set` replaces parameters and fields, as --set does: {"control.step": "0.1 ms"}; bare
    numbers are in the deck's units. `restart` continues from the newest dump. `report` is called
    with every line that the run prints, as in report=print.
    """
    name = "deck" if isinstance(deck, Mapping) else Path(deck).stem
    folder = Path(f"{name}.results" if folder is None else folder)
    path = _written(deck, folder) if isinstance(deck, Mapping) else Path(deck)
    words = [f"--set={name}={_text(value)}" for name, value in (set or {}).items()]
    words += ["--restart"] * restart
    command = [sys.executable, "-m", "crashsolve", "run", f"--output={folder}", *words, "--"]
    with TemporaryFile("w+", encoding="utf-8", errors="replace") as errors:
        child = subprocess.Popen(
            [*command, str(path)],
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            encoding="utf-8",
            errors="replace",
        )
        with child:
            try:
                assert child.stdout is not None
                for line in child.stdout:
                    if report:
                        report(line.rstrip("\n"))
            except BaseException:
                # the run dumps and stops, as by an interrupt from the keyboard
                child.terminate()
                raise
        errors.seek(0)
        message = errors.read().strip()
    if child.returncode != ExitCode.NORMAL:
        raise RunFailed(message or _ended(child.returncode), child.returncode, folder)
    return folder


def _ended(code: int) -> str:
    return f"killed by signal {-code}" if code < 0 else f"exit code {code}"


def _written(deck: Mapping[str, object], folder: Path) -> Path:
    """The deck as a file of the results folder. JSON is YAML; raises TypeError for other values."""
    text = json.dumps(deck, indent=1, default=_plain, allow_nan=False)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "deck.yaml"
    path.write_text(text + "\n", encoding="utf-8")
    return path


def _text(value: object) -> str:
    """A value of `set` as a deck has it."""
    return value if isinstance(value, str) else json.dumps(value, default=_plain, allow_nan=False)


def _plain(value: object) -> object:
    """Numbers and arrays of numpy, and paths, as JSON has them."""
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{value!r} cannot stand in a deck")
